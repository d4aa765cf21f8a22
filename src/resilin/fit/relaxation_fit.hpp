#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace resilin {

/// Moduli that relax, over time or by frequency, in any unit.
struct RelaxationDescription {
  std::string place, title;
  std::string source;                              ///< name of the data in texts
  std::vector<double> times, moduli;               ///< relaxation test [s]
  std::vector<double> frequencies, storage, loss;  ///< dynamic test (DMA) [Hz]
  std::vector<double> tau;  ///< relaxation times [s]; empty: `branches`, evenly over the logarithm of time
  int branches = 0;         ///< 0: one for each decade of the data
};

/// A Prony series E(t) = E_inf + sum_i E_i exp(-t/tau_i) of such data.
struct RelaxationFit {
  RelaxationDescription description;
  double long_term = 0;                     ///< E_inf, in the unit of the data
  std::vector<double> tau, parts;           ///< branches that take part: tau_i [s], E_i
  double rms_error = 0, largest_error = 0;  ///< relative to |E| of each point

  double instantaneous() const;
  /// Shares g_i of the instantaneous or of the long-term modulus.
  std::vector<double> shares(bool of_long_term = false) const;
};

/// The least sum of squared relative errors with E_inf, E_i >= 0. Throws InputError where the data have no
/// long-term modulus or too few points.
RelaxationFit fit_relaxation(RelaxationDescription description);

std::string relaxation_text(const RelaxationFit& fit);
/// "41 times of a.csv; errors relative to the modulus: ..."
std::string relaxation_errors_text(const RelaxationFit& fit);
/// As text of a fit.json, in the unit of the data.
std::string relaxation_json_text(const RelaxationFit& fit);
/// viscoelastic = { ... }, to be pasted into a material.
std::string relaxation_toml(const RelaxationFit& fit);
/// One page, without a network: data, curve and table.
std::string relaxation_page(const RelaxationFit& fit);
/// fit.json, fit.html and material.toml. Throws FileError.
void write_relaxation(const RelaxationFit& fit, const std::filesystem::path& folder);

}  // namespace resilin
