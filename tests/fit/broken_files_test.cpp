// Files of fits that are broken at random: each is refused in one line, or fitted to numbers.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/fit/fit_output.hpp"
#include "resilin/fit/fit_report.hpp"
#include "scene_fit_files.hpp"

namespace resilin::testing {
namespace {

class BrokenFiles : public SceneFitFiles {
 protected:
  std::size_t below(std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random);
  }

  /// A text with one thing wrong.
  std::string broken(std::string text) {
    static const std::vector<std::string> words = {"nan",   "inf", "-1", "0",    "1e400", "-0.0",
                                                   "\"x\"", "[]",  "{}", "true", "abc",   "1,2,3",
                                                   "-1e9",  "=",   "\"", "\xff"};
    switch (below(6)) {
      case 0:  // a letter less
        text.erase(below(text.size()), 1);
        break;
      case 1:  // something between
        text.insert(below(text.size()), words[below(words.size())]);
        break;
      case 2:  // the end is missing
        text.resize(below(text.size()));
        break;
      case 3: {  // a number is another thing
        std::size_t at = text.find_first_of("0123456789", below(text.size()));
        if (at == std::string::npos) break;
        const std::size_t end = text.find_first_not_of("0123456789.e-", at);
        text.replace(at, (end == std::string::npos ? text.size() : end) - at, words[below(words.size())]);
        break;
      }
      case 4: {  // a line is missing
        const std::size_t begin = text.rfind('\n', below(text.size())), end = text.find('\n', begin + 1);
        if (begin != std::string::npos && end != std::string::npos) text.erase(begin, end - begin);
        break;
      }
      default: {  // a line comes twice
        const std::size_t begin = text.rfind('\n', below(text.size())), end = text.find('\n', begin + 1);
        if (begin != std::string::npos && end != std::string::npos)
          text.insert(end, text.substr(begin, end - begin));
      }
    }
    return text;
  }

  /// Counts what was refused; everything else is a failure.
  template <class Fit>
  void expect_one_line_or_numbers(const std::string& what, const Fit& fit) {
    try {
      fit();
    } catch (const InputError& error) {
      const std::string line = error.what();
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
      EXPECT_GT(line.size(), 20U) << line << "\n" << what;
      ++refused;
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what() << "\n" << what;
    }
  }

  int refused = 0;
};

TEST_F(BrokenFiles, OfTestsAreRefusedInOneLineOrFitted) {
  const std::string csv =
      "stretch,nominal_stress [MPa]\n1.1,0.1\n1.3,0.25\n1.6,0.4\n2.0,0.55\n2.5,0.7\n3.0,0.85\n4.0,1.2\n";
  const std::string toml =
      "title = \"a rubber\"\n[[test]]\nname = \"one\"\nmode = \"uniaxial\"\nfile = \"a.csv\"\nweight = "
      "2\n[[test]]\nmode = "
      "\"planar\"\nunit = \"MPa\"\nstretch = [1.2, 1.5, 2]\nnominal_stress = [0.2, 0.4, 0.7]\nsigma = "
      "0.01\n[fit]\nlaws = "
      "[\"neo_hookean\", \"gent\"]\nresidual = \"absolute\"\nparameters = { limit = { bounds = [20, 200] } "
      "}\n";
  for (int i = 0; i < 400; ++i) {
    const std::string broken_csv = i % 2 == 0 ? broken(csv) : csv,
                      broken_toml = i % 2 == 1 ? broken(toml) : toml;
    folder.write("a.csv", broken_csv);
    expect_one_line_or_numbers(broken_toml + broken_csv, [&] {
      const FitReport report = fit_materials(read_fit(folder.write("fit.toml", broken_toml)));
      for (const LawFit& law : report.laws) {
        EXPECT_TRUE(std::isfinite(law.sum_of_squares)) << broken_toml << broken_csv;
        for (const ConstantEstimate& constant : law.constants)
          EXPECT_TRUE(std::isfinite(constant.value)) << broken_toml << broken_csv;
      }
      EXPECT_EQ(fit_page(report).find(">nan"), std::string::npos);
    });
  }
  EXPECT_GT(refused, 200);  // most are no files of a fit any more
  EXPECT_LT(refused, 380);
}

TEST_F(BrokenFiles, OfScenesAreRefusedInOneLineOrFitted) {
  folder.write("young.csv", moduli_csv(8e5, 3e5));
  const Simulation truth = run_to_the_end(scene(sagging_strip));
  const std::string csv = markers_csv(truth, {{0.3, 0.1, 0}, {0.7, 0.1, 0}, {1, 0.1, 0}}, 1e-4, random);
  folder.write("young.csv", moduli_csv(6e5, 4e5));
  const std::string toml =
      "[[experiment]]\nname = \"sag\"\nscene = \"scene.toml\"\nmarkers = { file = \"markers.csv\", sigma = "
      "1e-4 }\nreaction = "
      "{ of = \"wall\", value = [0, 1962], sigma = 100 }\nvolume = { value = 0.2, sigma = 0.1 "
      "}\n[[parameter]]\nkey = "
      "\"body.bar.material.youngs_modulus\"\nname = [\"root\", \"tip\"]\nbounds = [1e5, 2e6]\nper = "
      "\"value\"\n[fit]\nmax_solves = "
      "8\nstarts = 1\nregularise = { kind = \"smooth\", strength = 1 }\n";
  for (int i = 0; i < 150; ++i) {
    const std::string broken_csv = i % 3 == 0 ? broken(csv) : csv,
                      broken_toml = i % 3 != 0 ? broken(toml) : toml;
    folder.write("markers.csv", broken_csv);
    expect_one_line_or_numbers(broken_toml + broken_csv, [&] {
      const SceneFitReport report = fit(broken_toml);
      EXPECT_TRUE(std::isfinite(report.sum_of_squares)) << broken_toml << broken_csv;
      for (const FittedParameter& parameter : report.parameters)
        EXPECT_TRUE(std::isfinite(parameter.value)) << broken_toml << broken_csv;
      EXPECT_EQ(scene_fit_page(report).find(">nan"), std::string::npos);
    });
  }
  EXPECT_GT(refused, 60);
  EXPECT_LT(refused, 140);
}

}  // namespace
}  // namespace resilin::testing
