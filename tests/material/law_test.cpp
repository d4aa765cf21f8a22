#include "resilin/material/law.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <limits>
#include <set>
#include <sstream>
#include <string_view>

#include "resilin/core/error.hpp"
#include "resilin/material/reference.hpp"
#include "shared_data.hpp"

namespace resilin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string message_of(const auto& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::string constants_message(const std::map<std::string, double>& given) {
  return message_of([&] { resolve_constants(*find_law("neo_hookean"), given, "material"); });
}

TEST(Law, IsFoundByItsName) {
  ASSERT_NE(find_law("stable_neo_hookean"), nullptr);
  EXPECT_EQ(find_law("stable_neo_hookean")->name, "stable_neo_hookean");
  EXPECT_EQ(find_law("rubber"), nullptr);
  for (const LawInfo* law : laws()) EXPECT_EQ(find_law(law->name), law);
}

TEST(Law, HasATitleThatTellsItFromTheOthers) {
  std::set<std::string_view> titles;
  for (const LawInfo* law : laws()) {
    EXPECT_TRUE(titles.insert(law->title).second) << law->title << " is the title of two laws";
    EXPECT_NE(law->title, law->name) << "a title is for people";
  }
  EXPECT_EQ(find_law("stable_neo_hookean")->title, "Stable Neo-Hookean");
}

/// Those that a live scene can change to.
TEST(Law, NeedsOnlyHookeWhereYoungAndPoissonAloneMakeIt) {
  for (const LawInfo* law : laws()) {
    const auto is_made = [law](double poissons_ratio) {
      const std::map<std::string, double> given = {{"youngs_modulus", 1e5},
                                                   {"poissons_ratio", poissons_ratio}};
      return message_of([&] { resolve_constants(*law, given, "material"); }) == "no error";
    };
    EXPECT_EQ(law->needs_only_hooke(), law->max_fibres == 0 && is_made(0.1) && is_made(0.4)) << law->name;
  }
}

TEST(Law, DoesNotNeedOnlyHookeWhereAFreeConstantMustBeGiven) {
  LawInfo law = *find_law("gent");
  ASSERT_TRUE(law.needs_only_hooke());
  std::vector<ConstantText> constants(law.constants.begin(), law.constants.end());
  for (ConstantText& constant : constants) constant.fallback = std::numeric_limits<double>::quiet_NaN();
  law.constants = constants;
  EXPECT_FALSE(law.needs_only_hooke());
}

TEST(Law, UnknownNameListsTheLaws) {
  EXPECT_THAT(message_of([] { require_law("neo_hokean", "material.law"); }),
              AllOf(HasSubstr("material.law"), HasSubstr("saint_venant_kirchhoff"),
                    HasSubstr("did you mean \"neo_hookean\"?")));
}

TEST(Law, YoungAndPoissonAreConvertedAndOwnConstantsAreLiteral) {
  const LawInfo& law = *find_law("stable_neo_hookean");
  const double mu = 1e5 / 2.6, lambda = 1e5 * 0.3 / (1.3 * 0.4);
  const auto converted =
      resolve_constants(law, {{"youngs_modulus", 1e5}, {"poissons_ratio", 0.3}}, "material");
  EXPECT_NEAR(converted[0], mu, 1e-15 * mu);
  EXPECT_NEAR(converted[1], lambda + mu, 1e-15 * (lambda + mu));
  const auto literal = resolve_constants(law, {{"shear_modulus", 3.0}, {"lame_lambda", 2.0}}, "material");
  EXPECT_EQ(literal, (std::vector<double>{3.0, 2.0}));
}

TEST(Law, WrongConstantsAreRefusedAtTheirPlace) {
  EXPECT_THAT(constants_message({{"youngs_modulus", 1e5}, {"poissons_ratio", 0.5}}),
              AllOf(HasSubstr("material.poissons_ratio"), HasSubstr("0.495")));
  EXPECT_THAT(constants_message({{"youngs_modulus", -1.0}, {"poissons_ratio", 0.3}}),
              HasSubstr("material.youngs_modulus"));
  EXPECT_THAT(constants_message({{"youngs_modulus", 1e5}, {"poissons_ratio", -1.0}}), HasSubstr("(-1, 0.5)"));
  EXPECT_THAT(constants_message({{"young_modulus", 1e5}, {"poissons_ratio", 0.3}}),
              HasSubstr("did you mean \"youngs_modulus\"?"));
  EXPECT_THAT(constants_message({{"youngs_modulus", 1e5}}), HasSubstr("add poissons_ratio"));
  EXPECT_THAT(constants_message({}), HasSubstr("add youngs_modulus"));
  EXPECT_THAT(constants_message({{"shear_modulus", 1.0}}), HasSubstr("add lame_lambda"));
  EXPECT_THAT(constants_message({{"shear_modulus", 1.0}, {"poissons_ratio", 0.3}}), HasSubstr("mixture"));
  EXPECT_THAT(constants_message({{"shear_modulus", -1.0}, {"lame_lambda", 1.0}}),
              HasSubstr("material.shear_modulus"));
  EXPECT_THAT(constants_message({{"youngs_modulus", std::nan("")}, {"poissons_ratio", 0.3}}),
              HasSubstr("material.youngs_modulus"));
}

TEST(LawReference, IsThePageInTheDocumentation) {
  std::ifstream file(testing::source_folder() / "docs" / "laws.md");
  std::ostringstream page;
  page << file.rdbuf();
  EXPECT_EQ(page.str(), law_reference()) << "run: resilin materials --reference > docs/laws.md";
}

}  // namespace
}  // namespace resilin
