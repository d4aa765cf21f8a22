#pragma once

#include <variant>
#include <vector>

namespace resilin {

/// Times that differ by no more are one [s]: a share of the time, so that it serves picoseconds as well as
/// years.
double time_slack(double time);

/// A factor f(t) on a load or a prescribed motion. By default 1 at all times, and in a static run the load
/// factor; a function that is given takes its place, with the path parameter for t.
///
/// Where a slope jumps (a knot of a table, the ends of a ramp), rates are those from before, so that a step
/// that ends there sees what happened in it. Times are met within `time_slack`.
struct TimeFunction {
  struct Constant {};
  /// Straight between points (t_i, f_i); before the first and after the last it stays.
  struct Table {
    std::vector<double> times;   ///< rising [s]
    std::vector<double> values;  ///< as many
  };
  /// f = offset + amplitude sin(2 pi frequency t + phase)
  struct Sine {
    double frequency = 1;  ///< [Hz]
    double amplitude = 1;
    double phase = 0;  ///< [degrees]
    double offset = 0;
  };
  /// 0 until `from`, then straight up to 1 at `until`.
  struct Ramp {
    double from = 0;   ///< [s]
    double until = 1;  ///< later than `from` [s]
  };
  std::variant<Constant, Table, Sine, Ramp> form = Constant{};

  bool is_constant() const { return std::holds_alternative<Constant>(form); }
  double value(double time) const;
  /// Factor of a load at a time and a load factor.
  double factor(double time, double load) const { return is_constant() ? load : value(time); }
  double rate(double time) const;         ///< df/dt [1/s]
  double second_rate(double time) const;  ///< d2f/dt2 [1/s^2]
  double integral(double time) const;     ///< from 0 to `time` >= 0 [s]
  std::vector<double> kinks() const;      ///< times where the rate jumps, rising [s]
};

}  // namespace resilin
