#include <algorithm>
#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/law_fit.hpp"

namespace resilin {
namespace {

/// Laws that are fitted, and those that are not although "all" or the usual laws were asked for.
std::vector<LawChoice> choices_of(const FitDescription& description, bool is_compressible,
                                  std::vector<LawNotFitted>& not_fitted) {
  const std::string place = description.place + ".laws";
  const bool wants_all = description.laws == std::vector<std::string>{"all"};
  const std::vector<std::string> names = wants_all                  ? fit_law_names()
                                         : description.laws.empty() ? usual_fit_laws()
                                                                    : description.laws;
  std::vector<LawChoice> choices;
  for (const std::string& name : names) {
    if (wants_all && name == "ogden") continue;  // another name of ogden3
    try {
      LawChoice choice = choose_law(name, is_compressible, place);
      if (std::ranges::find(choices, choice.name, &LawChoice::name) == choices.end())
        choices.push_back(std::move(choice));
    } catch (const InputError& error) {
      if (!wants_all) throw;
      not_fitted.push_back({name, error.what()});
    }
  }
  apply_settings(choices, description.constants);
  return choices;
}

void weigh_by_akaike(std::vector<LawFit>& fits) {
  std::ranges::stable_sort(fits, [](const LawFit& a, const LawFit& b) {
    return a.aicc != b.aicc ? a.aicc < b.aicc : a.sum_of_squares < b.sum_of_squares;
  });
  double total = 0;
  for (LawFit& fit : fits) {
    fit.akaike_weight = std::isfinite(fit.aicc) ? std::exp(-0.5 * (fit.aicc - fits.front().aicc)) : 0;
    total += fit.akaike_weight;
  }
  for (LawFit& fit : fits)
    if (total > 0) fit.akaike_weight /= total;
}

/// Laws that differ in how they resist changes of volume alone are one in the incompressible limit.
void tell_same_fits(std::vector<LawFit>& fits) {
  for (std::size_t i = 0; i < fits.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const bool is_same =
          fits[k].num_fitted == fits[i].num_fitted &&
          std::abs(fits[k].sum_of_squares - fits[i].sum_of_squares) <= 1e-9 * fits[k].sum_of_squares &&
          std::abs(fits[k].shear_modulus - fits[i].shear_modulus) <= 1e-6 * fits[k].shear_modulus;
      if (!is_same) continue;
      fits[i].remarks.push_back("the same curves as " + fits[k].name +
                                ": they differ in how they resist changes of volume");
      break;
    }
}

}  // namespace

FitReport fit_materials(FitDescription description) {
  FitReport report;
  report.is_compressible = is_compressible_fit(description);
  report.warnings = description.warnings;
  const FitData data = collect_data(description, report.is_compressible);
  for (std::string& warning : data_warnings(description)) report.warnings.push_back(std::move(warning));
  const bool are_named = !description.laws.empty() && description.laws != std::vector<std::string>{"all"};
  for (const LawChoice& choice : choices_of(description, report.is_compressible, report.not_fitted)) {
    try {
      report.laws.push_back(fit_law(choice, data, description));
    } catch (const InputError& error) {
      const bool is_only_law = are_named && description.laws.size() == 1;
      const bool has_too_few = data.states.size() < choice.fitted().size();
      if (is_only_law || (are_named && has_too_few)) throw;
      report.not_fitted.push_back({choice.name, error.what()});
    }
  }
  if (report.laws.empty())
    throw InputError(description.place, "no law could be fitted: " + report.not_fitted.front().reason);
  weigh_by_akaike(report.laws);
  if (!report.is_compressible) tell_same_fits(report.laws);
  report.description = std::move(description);
  return report;
}

}  // namespace resilin
