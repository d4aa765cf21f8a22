"""Load curves of FEBio's files."""

from materials import InexpressibleError, vector


def lagrange(t, points):
    """The parabola through three points."""
    (t0, f0), (t1, f1), (t2, f2) = points
    return (
        f0 * (t - t1) * (t - t2) / ((t0 - t1) * (t0 - t2))
        + f1 * (t - t0) * (t - t2) / ((t1 - t0) * (t1 - t2))
        + f2 * (t - t0) * (t - t1) / ((t2 - t0) * (t2 - t1))
    )


def line(t, first, second):
    (t0, f0), (t1, f1) = first, second
    return f0 + (f1 - f0) * (t - t0) / (t1 - t0)


class Curve:
    """A function of time. Its smooth interpolation is the mean of parabolas through three points."""

    def __init__(self, controller):
        if controller.get("type") not in ("loadcurve", "point"):
            raise InexpressibleError(f"load controller {controller.get('type')}")
        self.interpolation = controller.findtext("interpolate", "LINEAR").upper()
        self.extension = controller.findtext("extend", "CONSTANT").upper()
        self.points = []
        for point in controller.find("points"):
            if not self.points or vector(point.text)[0] > self.points[-1][0]:
                self.points.append(vector(point.text))
        if self.interpolation not in ("LINEAR", "STEP", "SMOOTH"):
            raise InexpressibleError(f"load curve with interpolation {self.interpolation}")

    def is_constant_after_start(self):
        """Whether its value at all t > 0 is one."""
        if self.interpolation == "STEP":
            return len({value for t, value in self.points if t > 0}) == 1
        return len({value for _, value in self.points}) == 1

    def __call__(self, t):
        first, last = self.points[0], self.points[-1]
        if t <= first[0] or len(self.points) == 1:
            return first[1]
        if t > last[0] + 1e-12 * abs(last[0]):
            if self.extension == "CONSTANT":
                return last[1]
            if self.extension == "REPEAT":
                while t > last[0] * (1 + 1e-12):
                    t -= last[0] - first[0]
                return self(t)
            if self.extension == "EXTRAPOLATE" and self.interpolation == "LINEAR":
                return line(t, *self.points[-2:])
            raise InexpressibleError(f"load curve with extension {self.extension}")
        i = next(i for i, (time, _) in enumerate(self.points) if t <= time + 1e-12 * abs(time))
        if self.interpolation == "STEP":
            return self.points[i][1]
        if self.interpolation == "LINEAR" or len(self.points) == 2:
            return line(t, *self.points[i - 1 : i + 1])
        starts = [k for k in (i - 2, i - 1) if 0 <= k <= len(self.points) - 3]
        values = [lagrange(t, self.points[k : k + 3]) for k in starts]
        if len(values) == 1:
            return values[0]
        return line(t, (self.points[i - 1][0], values[0]), (self.points[i][0], values[1]))
