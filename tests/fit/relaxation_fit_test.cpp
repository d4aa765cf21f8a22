// Prony series from relaxation tests and dynamic tests (DMA).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <random>

#include "resilin/core/error.hpp"
#include "resilin/fit/fit_file.hpp"
#include "resilin/fit/relaxation_fit.hpp"
#include "temporary_folder.hpp"

namespace resilin {
namespace {

using ::testing::HasSubstr;

/// 2 MPa under a sudden load, of which 1.1 stay.
struct RelaxingRubber {
  double long_term = 1.1;
  std::vector<double> parts = {0.5, 0.3, 0.1}, tau = {0.1, 1, 10};

  double modulus(double time) const {
    double sum = long_term;
    for (std::size_t k = 0; k < tau.size(); ++k) sum += parts[k] * std::exp(-time / tau[k]);
    return sum;
  }
  RelaxationDescription held(double noise = 0) const {
    RelaxationDescription d;
    d.place = "a.toml: relaxation";
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    for (int k = 0; k <= 40; ++k) {
      d.times.push_back(0.01 * std::pow(10, 0.1 * k));
      d.moduli.push_back(modulus(d.times.back()) * (1 + noise * normal(random)));
    }
    return d;
  }
  RelaxationDescription shaken() const {
    RelaxationDescription d;
    d.place = "a.toml: relaxation";
    for (int k = 0; k <= 12; ++k) {
      const double w = 0.01 * std::pow(10, 0.25 * k + 0.5);
      d.frequencies.push_back(w / (2 * std::numbers::pi));
      double storage = long_term, loss = 0;
      for (std::size_t i = 0; i < tau.size(); ++i) {
        const double x = w * tau[i];
        storage += parts[i] * x * x / (1 + x * x);
        loss += parts[i] * x / (1 + x * x);
      }
      d.storage.push_back(storage);
      d.loss.push_back(loss);
    }
    return d;
  }
};

TEST(Relaxation, OfKnownTimesGivesTheSharesBack) {
  const RelaxingRubber rubber;
  for (RelaxationDescription data : {rubber.held(), rubber.shaken()}) {
    data.tau = rubber.tau;
    const RelaxationFit fit = fit_relaxation(data);
    EXPECT_EQ(fit.tau, rubber.tau);
    EXPECT_NEAR(fit.long_term, 1.1, 1e-9);
    EXPECT_NEAR(fit.instantaneous(), 2, 1e-9);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(fit.shares()[k], 0.5 * rubber.parts[k], 1e-9);
    EXPECT_NEAR(fit.shares(true)[0], 0.5 / 1.1, 1e-9);
    EXPECT_LT(fit.largest_error, 1e-9);
  }
}

TEST(Relaxation, OfUnknownTimesFollowsTheCurveWithABranchForEachDecade) {
  const RelaxingRubber rubber;
  const RelaxationFit fit = fit_relaxation(rubber.held(0.005));
  EXPECT_LE(fit.tau.size(), 4U);
  EXPECT_LT(fit.rms_error, 0.015);
  EXPECT_NEAR(fit.instantaneous(), 2, 0.1);
  EXPECT_NEAR(fit.long_term, 1.1, 0.02);
  RelaxationDescription data = rubber.held();
  data.branches = 8;
  EXPECT_LT(fit_relaxation(data).rms_error, 0.004);
}

struct RelaxationFile : ::testing::Test {
  testing::TemporaryFolder folder;

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream file(folder.path() / name);
    file << text;
    return (folder.path() / name).string();
  }
  std::string error_of(const std::string& text) const {
    try {
      fit_relaxation(std::get<RelaxationDescription>(read_any_fit(write("a.toml", text))));
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
};

TEST_F(RelaxationFile, BecomesATableForAMaterial) {
  write("a.csv", "Time [s],Stress (kPa)\n0,200\n0.1,170\n1,140\n10,121\n100,120\n");
  const RelaxationFit fit = fit_relaxation(std::get<RelaxationDescription>(
      read_any_fit(write("a.toml", "title = \"R\"\n[relaxation]\nfile = \"a.csv\"\ntau = [0.1, 1, 10]\n"))));
  EXPECT_NEAR(fit.instantaneous(), 200, 2);
  write_relaxation(fit, folder.path() / "out");
  std::ifstream file(folder.path() / "out" / "material.toml");
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  EXPECT_THAT(text, HasSubstr("\nviscoelastic = { g = [0."));
  EXPECT_THAT(text, HasSubstr("moduli = \"long_term\""));
  EXPECT_THAT(relaxation_text(fit), HasSubstr("5 times of a.csv"));
  std::ifstream written(folder.path() / "out" / "fit.html");
  const std::string page((std::istreambuf_iterator<char>(written)), {});
  EXPECT_THAT(page, HasSubstr("<title>R</title>"));
  EXPECT_THAT(page, HasSubstr("5 times of a.csv"));
  EXPECT_THAT(page, HasSubstr("<path class=\"line\""));
  std::size_t circles = 0;  // a time of 0 has no place on a logarithmic axis
  for (std::size_t at = page.find("<circle"); at != page.npos; at = page.find("<circle", at + 1)) ++circles;
  EXPECT_EQ(circles, 4U);
}

TEST_F(RelaxationFile, OfADynamicTestHasTwoPictures) {
  RelaxationDescription data = RelaxingRubber().shaken();
  data.tau = RelaxingRubber().tau;
  const std::string page = relaxation_page(fit_relaxation(data));
  EXPECT_THAT(page, HasSubstr("storage modulus"));
  EXPECT_THAT(page, HasSubstr("loss modulus"));
  EXPECT_THAT(page, HasSubstr("frequency [Hz]"));
}

TEST_F(RelaxationFile, OfBadInputIsRefusedInOneLine) {
  EXPECT_THAT(error_of("[relaxation]\ntime = [0, 1]\nmodulus = [2, 1, 1]"),
              HasSubstr("relaxation.modulus: expected 2 numbers, got 3"));
  EXPECT_THAT(error_of("[relaxation]\ntime = [-1, 1]\nmodulus = [2, 1]"),
              HasSubstr("relaxation.time, row 1: expected a number >= 0, got -1"));
  EXPECT_THAT(error_of("[relaxation]\nbranches = 2"), HasSubstr("got neither"));
  EXPECT_THAT(
      error_of("[relaxation]\ntime = [0, 1, 2, 3]\nmodulus = [8, 4, 2, 1]\ntau = [1.4426950408889634]"),
      HasSubstr("a modulus that stays after a long time"));
  EXPECT_THAT(error_of("[relaxation]\ntime = [0.1, 1, 2]\nmodulus = [3, 3, 3]"),
              HasSubstr("data that relax"));
  EXPECT_THAT(error_of("[relaxation]\ntime = [0.1, 1]\nmodulus = [3, 2]\nbranches = 4"),
              HasSubstr("set branches to a smaller number"));
  EXPECT_THAT(error_of("[relaxation]\ntau = [0]"), HasSubstr("relaxation times > 0 s"));
  EXPECT_THAT(error_of("[relaxation]\nfile = \"a.csv\"\n[[test]]"), HasSubstr("\"test\""));
  write("ms.csv", "time [ms],stress\n0,2\n1,1\n");
  EXPECT_THAT(error_of("[relaxation]\nfile = \"ms.csv\""),
              HasSubstr("expected time [s] in ms.csv, got [ms]"));
}

}  // namespace
}  // namespace resilin
