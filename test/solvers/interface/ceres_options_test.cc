#include "plumbline/solvers/interface/ceres_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <limits>
#include <string>
#include <variant>

namespace plumbline {
namespace {

using testing::HasSubstr;

std::string TextOf(const CeresValue& value) {
  if (const bool* on = std::get_if<bool>(&value)) return *on ? "TRUE" : "false";
  if (const int* number = std::get_if<int>(&value)) return std::to_string(*number);
  if (const double* number = std::get_if<double>(&value)) return std::to_string(*number);
  return std::get<std::string>(value);
}

TEST(CeresOptionsTest, EveryFieldIsReadAndSetByItsName) {
  for (const CeresField& field : CeresFields()) {
    SCOPED_TRACE(field.name);
    CeresOptions options;
    const CeresValue before = field.get(options);
    EXPECT_TRUE(SetCeresField(field.name, TextOf(before), &options).ok());
    if (const bool* on = std::get_if<bool>(&before)) {
      EXPECT_TRUE(SetCeresField(field.name, *on ? "false" : "true", &options).ok());
      EXPECT_EQ(field.get(options), CeresValue(!*on));
    } else if (std::holds_alternative<std::string>(before)) {
      EXPECT_FALSE(SetCeresField(field.name, "nonsense", &options).ok());
      EXPECT_EQ(field.get(options), before);
    } else {
      EXPECT_TRUE(SetCeresField(field.name, "7", &options).ok());
      EXPECT_EQ(TextOf(field.get(options)).substr(0, 1), "7");
    }
  }
}

// The words in `values`, in capitals as Ceres has them.
TEST(CeresOptionsTest, TheNamesThatAreListedAreTaken) {
  for (const CeresField& field : CeresFields()) {
    CeresOptions options;
    if (!std::holds_alternative<std::string>(field.get(options))) continue;
    std::string word;
    for (const char* letter = field.values; true; ++letter) {
      if (std::islower(static_cast<unsigned char>(*letter)) != 0 || *letter == '_') {
        word += static_cast<char>(*letter == '_' ? '_' : std::toupper(*letter));
        continue;
      }
      if (word == "ANOTHER") break;
      if (!word.empty() && word != "OR") {
        EXPECT_TRUE(field.set(word, &options)) << field.name << " " << word;
        EXPECT_EQ(field.get(options), CeresValue(word));
      }
      word.clear();
      if (*letter == '\0') break;
    }
  }
}

TEST(CeresOptionsTest, ErrorsNameTheFieldAndWhatItTakes) {
  CeresOptions options;
  EXPECT_THAT(SetCeresField("dogleg", "x", &options).message(),
              HasSubstr("no option 'dogleg' of ceres; there are minimizer_type, linear_solver"));
  EXPECT_EQ(SetCeresField("dogleg_type", "x", &options).message(),
            "dogleg_type = 'x', but it must be traditional_dogleg or subspace_dogleg");
  EXPECT_EQ(SetCeresField("eta", "1e999", &options).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(SetCeresField("eta", "0.1 ", &options).code(), StatusCode::kInvalidArgument);
}

TEST(CeresOptionsTest, ChecksWhatCeresDoesNot) {
  CeresOptions options;
  EXPECT_TRUE(options.Check(nullptr));
  options.eta = std::numeric_limits<double>::quiet_NaN();
  std::string error;
  EXPECT_FALSE(options.Check(&error));
  EXPECT_EQ(error, "eta = nan, but it must be finite");
}

TEST(CeresOptionsTest, CeresTakesTheDefaults) {
  EXPECT_TRUE(CheckCeresOptions(CeresOptions()).ok());
  CeresOptions options;
  options.min_linear_solver_iterations = 10;
  options.max_linear_solver_iterations = 5;
  EXPECT_THAT(CheckCeresOptions(options).message(), HasSubstr("min_linear_solver_iterations"));
}

}  // namespace
}  // namespace plumbline
