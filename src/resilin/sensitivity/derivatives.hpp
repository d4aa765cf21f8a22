#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "resilin/sensitivity/parameter.hpp"
#include "resilin/sensitivity/term_changes.hpp"
#include "resilin/simulation/simulation.hpp"

namespace resilin {

/// Numbers of one frame: what they change by, or slopes of a result by them. What is empty does not count.
struct FrameChange {
  VectorX positions{};               ///< positions of all nodes, dim each [m]
  VectorX velocities{};              ///< in motion [m/s]
  std::vector<Vector3> reactions{};  ///< reactions of the supports, in their order [N]
};

/// Memory and tolerances of an adjoint pass.
struct DerivativeOptions {
  /// Motion: whole states are kept at so many places of the run, and steps between them are made again when
  /// they are wanted, to the same bits; 0: the places of all steps are kept.
  int checkpoints = 0;
  /// Statics: gradients where forces do not balance well come with a warning of how far off they may be,
  /// which doubles their price.
  bool estimates_errors = true;
  /// Analyses of matrices, which runs of one mesh may share; changes no result.
  std::shared_ptr<AnalysisCache> analyses = nullptr;
  /// Asked after every Newton iteration and between steps; false: the run is given up (Interrupted).
  std::function<bool()> goes_on{};
};

/// A simulation that has been run, and the derivatives of what came out by parameters of its scene, exact to
/// rounding (docs/theory/gradients.md).
///
/// Frame 0 is the start, the others are the equilibria of the load steps or the ends of the time steps. What
/// comes out are the places of all nodes, their velocities and the reactions of the supports; a whole
/// objective is a sum over these and belongs to the caller.
class Derivatives {
 public:
  virtual ~Derivatives() = default;

  /// Runs the scene.
  /// @throws InputError   for an unknown parameter, for a scene whose results are not differentiable yet
  /// (what
  ///                      and why is said), and when a step does not converge
  /// @throws Interrupted  when `goes_on` says so
  static std::unique_ptr<Derivatives> run(Description description, const std::vector<std::string>& wrt,
                                          const DerivativeOptions& options = {});

  const World& world() const { return simulation_.world(); }
  const std::vector<Parameter>& parameters() const { return parameters_; }
  int num_frames() const { return static_cast<int>(frames_.size()); }
  /// Those that the scene asks for, whatever steps led there: at rest the start and the equilibria at load
  /// factors k / load_steps, in motion all.
  std::vector<int> asked_frames() const;
  /// Load steps that did not converge at first and were taken in parts.
  int num_halved_steps() const { return num_halved_steps_; }
  /// Positions of the frame; with checkpoints only the last one's are kept, the others computed again.
  virtual VectorX positions(int frame) = 0;
  /// Likewise [m/s]; empty at rest.
  virtual VectorX velocities(int /*frame*/) { return {}; }
  /// Warnings about the gradients so far, one line each: from the start, bodies that are equally stiff
  /// (kink_of_barrier); estimates of their error where forces do not balance well.
  const std::vector<std::string>& warnings() const { return warnings_; }
  const Frame& frame(int frame) const { return frames_[static_cast<std::size_t>(frame)]; }

  /// Room for slopes by what the parameters ask for ...
  WorldChange asked() const;
  /// ... and the slopes by each parameter that these are. For results that depend on numbers of the world not
  /// through the frames alone.
  std::vector<VectorX> by_parameters(const WorldChange& slopes) const;
  /// The slopes of w . dE/dx of one term by each parameter, with x held.
  /// @param number  of the term in the world
  /// @param term    it, or what a stage has made of it
  std::vector<VectorX> by_parameters_of_term(std::size_t number, const Energy& term, const VectorX& x,
                                             const VectorX& w, const Conditions& c) const;

  /// The slopes of a result by each parameter, from its slopes by the numbers of the frames: one for each
  /// frame, or fewer.
  /// @throws InputError  at an equilibrium that is not stable
  virtual std::vector<VectorX> transposed(const std::vector<FrameChange>& slopes) = 0;

  /// First-order change of the frames with the parameters.
  std::vector<FrameChange> forward(const std::vector<VectorX>& changes);

  /// The same along several directions; at least of the frames that are wanted, the others may stay empty.
  virtual std::vector<std::vector<FrameChange>> forward_all(
      const std::vector<std::vector<VectorX>>& directions, const std::vector<bool>& is_wanted) = 0;

 protected:
  Derivatives(Description description, const std::vector<std::string>& wrt, const DerivativeOptions& options);

  /// Takes a step; throws when it did not converge.
  StepReport step();
  void check_goes_on() const;
  WorldChange spread(const std::vector<VectorX>& changes) const;
  std::vector<VectorX> gathered(const TermChanges& terms, WorldChange slopes) const;
  /// Weights of the gradient at the fixed unknowns that make these weighted reactions.
  VectorX weights_of(const std::vector<Vector3>& reactions) const;
  std::vector<Vector3> reactions_of(VectorX gradient) const;

  DerivativeOptions options_;
  Simulation simulation_;
  TermLinks links_;
  std::vector<Parameter> parameters_;
  std::vector<Frame> frames_;
  int num_halved_steps_ = 0;
  std::vector<std::string> warnings_;
};

/// Derivatives of equilibria.
std::unique_ptr<Derivatives> differentiate_statics(Description description,
                                                   const std::vector<std::string>& wrt,
                                                   const DerivativeOptions& options);
/// Derivatives of motion in equal steps.
std::unique_ptr<Derivatives> differentiate_motion(Description description,
                                                  const std::vector<std::string>& wrt,
                                                  const DerivativeOptions& options);

}  // namespace resilin
