#include "plumbline/apps/report/html_text.h"

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "plumbline/apps/io/field_reader.h"

namespace plumbline {

std::string EscapeHtml(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size());
  for (const char c : Legible(text, "\n\t")) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string Base64(std::string_view bytes) {
  constexpr char kAlphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;  // three bytes, zeros beyond the end
    for (std::size_t j = i; j < i + 3; ++j) {
      group = group << 8 | (j < bytes.size() ? static_cast<unsigned char>(bytes[j]) : 0u);
    }
    for (int shift = 18; shift >= 0; shift -= 6) text += kAlphabet[group >> shift & 63u];
  }
  const std::size_t padding = (3 - bytes.size() % 3) % 3;
  return text.replace(text.size() - padding, padding, padding, '=');
}

std::string ScriptJson(const nlohmann::ordered_json& json) {
  std::string text;
  for (const char c : json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

void ExpandTemplate(std::string_view text, const std::map<std::string, std::string>& values,
                    std::ostream* out) {
  constexpr std::string_view kOpen = "{{", kClose = "}}";
  while (true) {
    const std::size_t open = text.find(kOpen);
    const std::size_t close = open == text.npos ? text.npos : text.find(kClose, open);
    *out << text.substr(0, close == text.npos ? text.npos : open);
    if (close == text.npos) return;
    std::string name(text.substr(open + kOpen.size(), close - open - kOpen.size()));
    text.remove_prefix(close + kClose.size());
    if (name.front() == '/') continue;
    const bool is_block = name.front() == '#';
    if (is_block) name.erase(0, 1);
    const auto value = values.find(name);
    const bool is_empty = value == values.end() || value->second.empty();
    if (is_block && is_empty) {
      const std::string end = "{{/" + name + "}}";
      const std::size_t block_end = text.find(end);
      text.remove_prefix(block_end == text.npos ? text.size() : block_end + end.size());
    } else if (!is_block && !is_empty) {
      *out << value->second;
    }
  }
}

}  // namespace plumbline
