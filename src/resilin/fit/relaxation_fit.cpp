#include "resilin/fit/relaxation_fit.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/fit_output.hpp"
#include "resilin/fit/inequalities.hpp"
#include "resilin/io/atomic_file.hpp"

namespace resilin {
namespace {

/// The data as rows (A, b) of A c = b for c = (E_inf, E_i), relative to |E| of their point.
struct RelaxationRows {
  DenseMatrix A;
  VectorX b;
  std::vector<std::size_t> points;  ///< number of the point of each row

  RelaxationRows(const RelaxationDescription& d, const std::vector<double>& tau) {
    const std::size_t num_rows = d.times.size() + 2 * d.frequencies.size();
    A = DenseMatrix::Zero(static_cast<Eigen::Index>(num_rows), static_cast<Eigen::Index>(tau.size() + 1));
    b.resize(A.rows());
    for (std::size_t p = 0; p < d.times.size(); ++p)
      add(p, d.moduli[p], std::abs(d.moduli[p]), 1, tau,
          [&](double time) { return std::exp(-d.times[p] / time); });
    for (std::size_t p = 0; p < d.frequencies.size(); ++p) {
      const double size = std::hypot(d.storage[p], d.loss[p]);
      const auto x = [&](double time) { return 2 * std::numbers::pi * d.frequencies[p] * time; };
      add(p, d.storage[p], size, 1, tau,
          [&](double time) { return x(time) * x(time) / (1 + x(time) * x(time)); });
      add(p, d.loss[p], size, 0, tau, [&](double time) { return x(time) / (1 + x(time) * x(time)); });
    }
  }

 private:
  template <class Decay>
  void add(std::size_t point, double value, double size, double of_long_term, const std::vector<double>& tau,
           const Decay& decay) {
    const auto row = static_cast<Eigen::Index>(points.size());
    A(row, 0) = of_long_term / size;
    for (std::size_t k = 0; k < tau.size(); ++k)
      A(row, static_cast<Eigen::Index>(k + 1)) = decay(tau[k]) / size;
    b[row] = value / size;
    points.push_back(point);
  }
};

/// Shortest and longest time of which the data tell [s].
std::pair<double, double> range_of_times(const RelaxationDescription& d) {
  std::vector<double> times;
  for (const double time : d.times)
    if (time > 0) times.push_back(time);
  for (const double frequency : d.frequencies) times.push_back(1 / (2 * std::numbers::pi * frequency));
  if (times.empty())
    throw InputError(d.place, "moduli at times above 0", "none", "give the modulus over time");
  const auto [least, most] = std::ranges::minmax(times);
  return {least, most};
}

std::vector<double> relaxation_times(const RelaxationDescription& d) {
  if (!d.tau.empty()) return d.tau;
  const auto [least, most] = range_of_times(d);
  const double decades = std::log10(most / least);
  const int count = d.branches > 0 ? d.branches : std::max(1, static_cast<int>(std::ceil(decades - 1e-9)));
  std::vector<double> tau;
  for (int k = 0; k < count; ++k) tau.push_back(least * std::pow(10, decades * (k + 0.5) / count));
  return tau;
}

std::string list_text(const std::vector<double>& values) {
  std::vector<std::string> texts;
  texts.reserve(values.size());
  for (const double value : values) texts.push_back(format_number(value));
  return "[" + join(texts) + "]";
}

}  // namespace

double RelaxationFit::instantaneous() const { return std::accumulate(parts.begin(), parts.end(), long_term); }

std::vector<double> RelaxationFit::shares(bool of_long_term) const {
  std::vector<double> shares = parts;
  for (double& share : shares) share /= of_long_term ? long_term : instantaneous();
  return shares;
}

RelaxationFit fit_relaxation(RelaxationDescription description) {
  const std::vector<double> tau = relaxation_times(description);
  const RelaxationRows rows(description, tau);
  if (rows.A.rows() < rows.A.cols())
    throw InputError(description.place,
                     std::to_string(rows.A.cols()) + " numbers or more for " + std::to_string(tau.size()) +
                         " relaxation times and the long-term modulus",
                     std::to_string(rows.A.rows()), "set branches to a smaller number");
  const VectorX c = nonnegative_least_squares(rows.A, rows.b);
  if (!(c[0] > 1e-9 * c.sum()))
    throw InputError(description.place, "data with a modulus that stays after a long time", "none",
                     "measure for longer, or give fewer or shorter relaxation times tau");
  const VectorX errors = rows.A * c - rows.b;
  std::vector<double> squares(rows.points.empty() ? 0 : rows.points.back() + 1, 0.0);
  for (std::size_t k = 0; k < rows.points.size(); ++k)
    squares[rows.points[k]] += errors[static_cast<Eigen::Index>(k)] * errors[static_cast<Eigen::Index>(k)];
  RelaxationFit fit;
  fit.long_term = c[0];
  for (std::size_t k = 0; k < tau.size(); ++k) {
    const double part = c[static_cast<Eigen::Index>(k + 1)];
    if (!(part > 1e-9 * c.sum())) continue;
    fit.tau.push_back(tau[k]);
    fit.parts.push_back(part);
  }
  if (fit.parts.empty())
    throw InputError(description.place, "data that relax", "moduli that do not fall with time",
                     "leave viscoelastic out, or give relaxation times tau within the time of the test");
  fit.largest_error = std::sqrt(std::ranges::max(squares));
  fit.rms_error =
      std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0) / static_cast<double>(squares.size()));
  fit.description = std::move(description);
  return fit;
}

std::string relaxation_errors_text(const RelaxationFit& fit) {
  const RelaxationDescription& d = fit.description;
  return std::to_string(d.times.size() + d.frequencies.size()) +
         (d.times.empty() ? " frequencies" : " times") + " of " + d.source +
         "; errors relative to the modulus: " + format_short(100 * fit.rms_error) +
         " % (root mean square), " + format_short(100 * fit.largest_error) + " % (largest)";
}

std::string relaxation_text(const RelaxationFit& fit) {
  std::vector<std::vector<std::string>> rows = {{"share g", "relaxation time tau [s]"}};
  const std::vector<double> shares = fit.shares();
  for (std::size_t k = 0; k < shares.size(); ++k)
    rows.push_back({format_short(shares[k]), format_short(fit.tau[k])});
  return (fit.description.title.empty() ? "" : fit.description.title + "\n") + relaxation_errors_text(fit) +
         "\n" + format_table(rows) + "modulus under a sudden load: " + format_short(fit.instantaneous()) +
         ", after a long time: " + format_short(fit.long_term) + ", in the unit of the data\n";
}

std::string relaxation_json_text(const RelaxationFit& fit) {
  const nlohmann::ordered_json json = {{"title", fit.description.title},
                                       {"data", fit.description.source},
                                       {"g", fit.shares()},
                                       {"tau", fit.tau},
                                       {"instantaneous_modulus", fit.instantaneous()},
                                       {"long_term_modulus", fit.long_term},
                                       {"rms_error", fit.rms_error},
                                       {"largest_error", fit.largest_error}};
  return json.dump(2) + "\n";
}

std::string relaxation_toml(const RelaxationFit& fit) {
  const std::string tau = ", tau = " + list_text(fit.tau);
  return "# " + relaxation_errors_text(fit) +
         ".\n# To be pasted into a material whose constants are those under a sudden load:\nviscoelastic = { "
         "g = " +
         list_text(fit.shares()) + tau +
         " }\n\n# Where they are those after a long time, as of slow tests:\n# viscoelastic = { g = " +
         list_text(fit.shares(/*of_long_term=*/true)) + tau +
         ", moduli = \"long_term\" }\n\n# The data are of one modulus: shares k of the bulk modulus are not "
         "fitted.\n";
}

void write_relaxation(const RelaxationFit& fit, const std::filesystem::path& folder) {
  make_fit_folder(folder);
  write_text(folder / "fit.json", relaxation_json_text(fit));
  write_text(folder / "fit.html", relaxation_page(fit));
  write_text(folder / "material.toml", relaxation_toml(fit));
}

}  // namespace resilin
