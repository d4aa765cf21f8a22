"""A soft arm is pulled by its middle until its tip is where it should be: a task in the manner of gymnasium.

`ReachTip` has the methods of gymnasium.Env, reset and step, with actions and observations as arrays; gymnasium itself
is not needed. The policy below is a proportional one; put yours in its place.
"""

import numpy as np

import resilin

ARM = {
    "simulation": {"kind": "dynamic", "time_step": 0.02, "end_time": 1},
    "body": [
        {
            "name": "arm",
            "element": "P1",
            "mesh": {"box": {"size": [1, 0.15, 0.15], "cells": [12, 2, 2]}},
            "material": {"law": "stable_neo_hookean", "youngs_modulus": 1e5, "poissons_ratio": 0.4, "density": 1000},
            "damping": {"mass": 4},
        }
    ],
    "fix": [{"where": {"group": "x_min"}}],
}


class ReachTip:
    """An action is how far the hand moves in a step, (3,) [m]; an observation is tip, hand and target, (9,) [m]."""

    most_steps = 200
    most_motion = 0.03  # [m] of the hand in a step
    tolerance = 0.02  # [m]

    def __init__(self):
        self.scene = resilin.LiveScene(ARM)
        start = self.scene.positions
        self.tip = int(np.argmin(np.linalg.norm(start - [1, 0.075, 0.15], axis=1)))

    def reset(self, seed=None):
        """Observation and information of a new start: the arm at rest, the target somewhere around its tip."""
        self.scene.release()
        self.scene.reset()
        middle = self.scene.grab([0.5, 0.075, 0.15])
        self.hand = self.scene.positions[middle]
        self.target = self.scene.positions[self.tip] + np.random.default_rng(seed).uniform(-0.15, 0.15, 3) * [0.1, 1, 1]
        self.steps = 0
        return self._observation(), {}

    def step(self, action):
        """Observation, reward, whether the task is done, whether time is up, information."""
        self.hand = self.hand + np.clip(action, -self.most_motion, self.most_motion)
        self.scene.drag(self.hand)
        report = self.scene.step()
        self.steps += 1
        distance = float(np.linalg.norm(self.scene.positions[self.tip] - self.target))
        done = distance < self.tolerance
        information = {"distance": distance, "force": self.scene.hand_force, "converged": report.converged}
        return self._observation(), -distance, done, self.steps >= self.most_steps, information

    def _observation(self):
        return np.concatenate([self.scene.positions[self.tip], self.hand, self.target])


def policy(observation):
    """The hand goes where the tip should go."""
    tip, _, target = np.split(observation, 3)
    return 0.05 * (target - tip)


def play(environment, seed):
    """The number of steps to the target, and how far off the tip is then."""
    observation, _ = environment.reset(seed)
    done = timeout = False
    while not (done or timeout):
        observation, _, done, timeout, information = environment.step(policy(observation))
    return environment.steps, information["distance"]


if __name__ == "__main__":
    environment = ReachTip()
    for seed in range(3):
        steps, distance = play(environment, seed)
        print(f"seed {seed}: the tip is {1000 * distance:.0f} mm from the target after {steps} steps")
