#include "resilin/optimize/newton.hpp"

namespace resilin {

std::string_view name(NewtonReport::Status status) {
  switch (status) {
    case NewtonReport::Status::converged:
      return "converged";
    case NewtonReport::Status::max_iterations:
      return "max_iterations";
    case NewtonReport::Status::stalled:
      return "stalled";
    case NewtonReport::Status::singular:
      return "singular";
    case NewtonReport::Status::out_of_digits:
      return "out_of_digits";
    case NewtonReport::Status::not_finite:
      return "not_finite";
    case NewtonReport::Status::interrupted:
      return "interrupted";
  }
  return "";
}

}  // namespace resilin
