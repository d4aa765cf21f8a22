#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/core/spelling.hpp"
#include "resilin/fields/evaluator.hpp"
#include "resilin/scene/node.hpp"
#include "resilin/simulation/simulation.hpp"

namespace resilin {

/// Reduction of a quantity's values over all steps of a run, the start included.
enum class OverSteps { last, first, min, max, max_abs, mean, all };
constexpr std::array<std::string_view, 7> spellings(OverSteps) {
  return {"last", "first", "min", "max", "max_abs", "mean", "all"};
}

/// A column of the table of a sweep.
struct Quantity {
  std::string name;  ///< name of its column
  std::string of;    ///< "probe.tip.displacement.z", "max.von_mises"
  OverSteps over = OverSteps::last;
  std::string place;  ///< place of messages
};

/// Reads `quantities`: texts, or tables with name, of and over. Names are those of one column each.
std::vector<Quantity> read_quantities(const SceneNode& node);

/// Default quantities of a scene: probes, reactions, elastic energy and smallest volume ratio.
std::vector<Quantity> usual_quantities(const Description& description);

/// All that a scene can be asked for.
std::vector<std::string> quantity_names(const Description& description);

/// Throws InputError naming the nearest when a quantity is of nothing that there is in such a scene.
void check_quantities(const std::vector<Quantity>& quantities, const Description& description);

/// Takes the quantities of a run as it goes, in memory that does not grow with its steps (but for `all`).
class QuantityRecorder {
 public:
  /// Both are kept by reference.
  QuantityRecorder(const std::vector<Quantity>& quantities, const World& world);

  void record(const Simulation& simulation);  ///< at the start, and after each step
  void finish(const Simulation& simulation);  ///< once no other step follows

  /// For each quantity one number, NaN where there is none; for `all` one for each step.
  std::vector<std::vector<double>> values() const;

 private:
  double value_of(const Quantity& quantity, const Simulation& simulation);
  double field_extreme(const std::string& of, const Simulation& simulation);

  const std::vector<Quantity>& quantities_;
  const World& world_;
  std::unique_ptr<FieldEvaluator> evaluator_;  ///< made when a field is asked for
  int step_ = -1;                              ///< step of the fields in `fields_`
  std::vector<FieldValues> fields_;
  struct Taken {
    std::vector<double> values;
    int count = 0;
  };
  std::vector<Taken> taken_;
};

}  // namespace resilin
