#include "resilin/core/vocabulary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "resilin/core/error.hpp"
#include "shared_data.hpp"

namespace resilin {
namespace {

using ::testing::HasSubstr;

struct Wish {
  std::string word;
  std::vector<std::string> known;
  std::string cure;
};

TEST(Vocabulary, SaysWhatAWordIsCalledHere) {
  const std::vector<Wish> wishes = {
      {"force", {"nodal_force", "traction"}, "it is called \"nodal_force\" here"},
      {"plane", {"half_space", "box"}, "it is called \"half_space\" here"},
      {"Ground-Plane", {"half_space"}, "it is called \"half_space\" here"},
      {"quasi-static", {"static", "dynamic"}, "it is called \"static\" here"},
      {"follower_load", {"name"}, "it is [[load]] of kind \"pressure\" here"},
      {"hgo", {"name"}, "it is called body.material.law here"},
      {"prony", {"law", "viscoelastic"}, "it is called \"viscoelastic\" here"},
      {"mpc", {"tie", "constraint"}, "it is called \"constraint\" here"},
      {"bonded", {"tie", "constraint"}, "it is called \"tie\" here"},
      {"plane stress", {"2", "3"}, "it is simulation.dimension = \"plane_stress\" here"},
      {"axisymmetric", {"2", "3"}, "it is simulation.dimension = \"axisymmetric\" here"},
      {"viscoelastic", {"law", "name"}, "it is called body.material.viscoelastic here"},
      {"rigid",
       {"collider"},
       "it is called [[collider]] (prescribed motion) or body.rigid (free motion) here"},
      {"rigid_body", {"material", "rigid"}, "it is called \"rigid\" here"},
      {"constitutive", {"constraint"}, "it is called body.material here"},
      {"displacement", {"element"}, "it is called [[fix]] here"},
      {"self_contact", {"contact"}, "it is called \"contact\" here"},
      {"E", {"material", "mesh"}, "it is called body.material.youngs_modulus here"},
      {"mu", {"material", "mesh"}, "it is called body.material.shear_modulus here"},
      {"density", {"material", "mesh"}, "it is called body.material.density here"},
      {"gravity", {"material", "mesh"}, "it is called simulation.gravity here"},
      {"amplitude", {"simulation", "fix"}, "it is called fix.time_function, load.time_function here"},
      {"solver", {"kind", "gravity"}, "it is called solver.kind here"},
      {"shear", {"law", "shear_modulus"}, "it is called \"shear_modulus\" here"},
  };
  for (const Wish& wish : wishes) EXPECT_EQ(cure_of_word(wish.word, wish.known), wish.cure) << wish.word;
}

TEST(Vocabulary, SaysWhatIsNotAvailable) {
  for (const char* word : {"plasticity", "shell", "gpu", "damage", "explicit", "thermal"})
    EXPECT_EQ(cure_of_word(word, std::vector<std::string>{"time_step", "tip"}),
              "not available (docs/limits.md)")
        << word;
}

TEST(Vocabulary, SaysWhatToDoWhereNoKeyStandsForAWord) {
  const std::vector<std::string> known = {"law", "youngs_modulus", "name"};
  EXPECT_EQ(cure_of_word("restart", known), "run it with the option --resume");
  EXPECT_EQ(cure_of_word("encastre", std::vector<std::string>{"components"}),
            "a [[fix]] without components holds all of them");
  EXPECT_EQ(cure_of_word("ccd", known), "continuous collision detection is always on");
  EXPECT_EQ(cure_of_word("bulk_modulus", known),
            "without a bulk_modulus in the law, poissons_ratio says how compressible it is (docs/laws.md)");
  EXPECT_EQ(cure_of_word("kappa", std::vector<std::string>{"bulk_modulus"}),
            "it is called \"bulk_modulus\" here");
}

TEST(Vocabulary, LeavesOtherWordsToTheNearestOne) {
  EXPECT_EQ(cure_of_word("densty", std::vector<std::string>{"density", "law"}), "did you mean \"density\"?");
  EXPECT_EQ(cure_of_word("xylophone", std::vector<std::string>{"density", "law"}), "");
}

TEST(Vocabulary, HasEveryWordOfARowOnceAndInSmallLetters) {
  for (const ForeignWord& foreign : vocabulary()) {
    EXPECT_NE(foreign.called.empty(), foreign.limit.empty() && foreign.advice.empty());
    std::set<std::string_view> all;
    for (const std::string_view word : foreign.words) {
      EXPECT_TRUE(all.insert(word).second) << word;
      EXPECT_TRUE(std::ranges::all_of(word, [](unsigned char c) {
        return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '_';
      })) << word;
    }
  }
}

TEST(Vocabulary, MeansTheKeyThatTheTableAtHandHas) {
  EXPECT_EQ(cure_of_word("E", std::vector<std::string>{"law", "youngs_modulus"}),
            "it is called \"youngs_modulus\" here");
  EXPECT_EQ(cure_of_word("mu", std::vector<std::string>{"friction"}), "it is called \"friction\" here");
  EXPECT_EQ(cure_of_word("mu", std::vector<std::string>{"shear_modulus"}),
            "it is called \"shear_modulus\" here");
  EXPECT_EQ(cure_of_word("torque", std::vector<std::string>{"force", "moment"}),
            "it is called \"moment\" here");
  EXPECT_EQ(cure_of_word("shell", std::vector<std::string>{"ball", "spherical_shell"}),
            "it is called \"spherical_shell\" here");
}

/// Text in small letters, blanks and line ends as one blank, without marks of emphasis.
std::string plain(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '*' || c == '`') continue;
    const bool is_blank = std::isspace(static_cast<unsigned char>(c)) != 0;
    if (is_blank && result.ends_with(' ')) continue;
    result += is_blank ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return result;
}

TEST(Vocabulary, OfWhatIsNotAvailableStandsInThePageOfLimits) {
  std::ifstream page(testing::source_folder() / "docs" / "limits.md");
  const std::string limits = plain({std::istreambuf_iterator<char>(page), {}});
  for (const ForeignWord& foreign : vocabulary()) EXPECT_THAT(limits, HasSubstr(std::string(foreign.limit)));
}

TEST(RefuseOwnWord, NamesTheWordsThatThereAre) {
  try {
    refuse_own_word("load[0].kind", "gpu", std::vector<std::string>{"auto", "direct"});
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "load[0].kind: expected one of auto, direct, got \"gpu\"; not available (docs/limits.md)");
  }
}

}  // namespace
}  // namespace resilin
