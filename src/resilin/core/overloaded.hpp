#pragma once

namespace resilin {

/// A visitor of a std::variant: one lambda for each kind.
template <class... Lambda>
struct Overloaded : Lambda... {
  using Lambda::operator()...;
};

/// Deduces the kinds from the lambdas.
template <class... Lambda>
Overloaded(Lambda...) -> Overloaded<Lambda...>;

}  // namespace resilin
