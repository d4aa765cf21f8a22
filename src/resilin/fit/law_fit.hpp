#pragma once

#include "resilin/fit/fit_data.hpp"
#include "resilin/fit/fit_report.hpp"
#include "resilin/fit/law_choice.hpp"

namespace resilin {

/// Fits one law. Throws InputError, whose text says why, when it cannot be.
LawFit fit_law(const LawChoice& choice, const FitData& data, const FitDescription& description);

// law_search.cpp
/// The best constants that a search finds, within the limits that the description asks for.
struct SearchResult {
  std::vector<double> constants;  ///< SI
  double sum = 0;                 ///< in units of the problem
  DenseMatrix reached;            ///< limits that hold the fitted constants, by these in units of the problem
  bool is_held_by_stability = false, is_held_by_range = false;
  std::optional<std::vector<double>>
      free_constants;  ///< free constants of the optimum without limits, when it is another
  double free_sum = 0;
  /// Other optima that these data cannot tell from the best, as far as the search has found them.
  std::vector<std::vector<double>> rivals;
};
SearchResult search_constants(const LawChoice& choice, const FitData& data,
                              const FitDescription& description);

// law_remarks.cpp
/// Consequences of the constants: stability, curves, moduli and remarks.
void tell_material(const LawChoice& choice, const std::vector<double>& constants,
                   const FitDescription& description, LawFit& fit);
/// Exponents at the end of the search, signs that make no difference, intervals that hold 0.
void tell_ambiguities(const LawChoice& choice, const std::vector<double>& constants, const FitData& data,
                      const FitDescription& description, LawFit& fit);
/// Optima that are as good.
void tell_rivals(const LawChoice& choice, const SearchResult& found, LawFit& fit);
/// Effect of the limits on the fit.
void tell_limits(const LawChoice& choice, const SearchResult& found, const FitData& data,
                 const FitDescription& description, LawFit& fit);

/// The modes of the tests, and the three that any rubber is judged by.
std::vector<TestMode> shown_modes(const FitDescription& description, bool is_compressible);

}  // namespace resilin
