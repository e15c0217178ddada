#ifndef PLUMBLINE_APPS_REPORT_HTML_TEXT_H_
#define PLUMBLINE_APPS_REPORT_HTML_TEXT_H_

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <ostream>
#include <string>
#include <string_view>

namespace plumbline {

/// Text as content or attribute value of HTML: & < > " and ' become references, and what is not
/// Legible, but for line ends and tabs, becomes \xNN.
std::string EscapeHtml(std::string_view text);

/// Bytes in the alphabet of RFC 4648, with padding.
std::string Base64(std::string_view bytes);

/// JSON that may stand inside a <script> element: every < is written as \u003c. Numbers that are
/// not finite become null; text that is not UTF-8 gets replacement characters.
std::string ScriptJson(const nlohmann::ordered_json& json);

/// Writes a template: {{name}} becomes values.at("name") as it is, and {{#name}}...{{/name}} stays
/// only if that value is not empty. Blocks may be nested. Values are not expanded again. A name
/// without a value counts as empty.
void ExpandTemplate(std::string_view text, const std::map<std::string, std::string>& values,
                    std::ostream* out);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_REPORT_HTML_TEXT_H_
