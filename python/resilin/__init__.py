"""Resilin: finite elements for hyperelastic solids.

Material    a constitutive model for arrays of deformation gradients: energy, stress, tangent, forces Elastic     the
elastic energy of a mesh: value, gradient, Hessian Simulation  a scene step by step; `run` simulates it to the end
LiveScene   an interactive scene: drag, pin and poke it while it moves Mesh        meshes from arrays, files, meshio
objects and generators fit         calibration of constitutive models from tests, with confidence intervals
fit_relaxation  Prony series from relaxation or dynamic tests fit_scenes parameter identification: numbers of scenes
from markers, reactions and probes value_and_gradient   an objective of a scene and its exact gradient (adjoint)
find_rest_shape  inverse design: the stress-free shape that deforms into the
drawn shape sweep       parameter sweeps, local or on a Dask cluster embed       interpolation weights of points
embedded in a mesh
"""

from resilin import loading  # first: it loads the libraries  # noqa: F401

# isort: split
from resilin import _core
from resilin._core import InputError
from resilin.catalog import laws
from resilin.differentiated import Differentiated
from resilin.differentiated_batch import DifferentiatedBatch
from resilin.elastic import Elastic
from resilin.embedding import embed
from resilin.fit import Fit, fit
from resilin.gradient import gradient, parameter_names, value_and_gradient
from resilin.live import LiveScene
from resilin.material import Material
from resilin.mesh import Mesh, MeshReport, read_mesh
from resilin.picture import Picture, picture
from resilin.relaxation_fit import RelaxationFit, fit_relaxation
from resilin.rest_shape import RestShape, find_rest_shape
from resilin.result import Result, Step
from resilin.scene_check import SceneCheck, check
from resilin.scene_fit import SceneFit, fit_scenes
from resilin.simulation import Simulation, run
from resilin.sweeps import SweepTable, read_sweep, sweep
from resilin.threads import num_threads, set_num_threads

InputError.__module__ = __name__
__version__ = _core.version()

__all__ = [
    "Differentiated",
    "DifferentiatedBatch",
    "Elastic",
    "Fit",
    "InputError",
    "LiveScene",
    "Material",
    "Mesh",
    "MeshReport",
    "Picture",
    "RelaxationFit",
    "RestShape",
    "Result",
    "SceneCheck",
    "SceneFit",
    "Simulation",
    "Step",
    "SweepTable",
    "__version__",
    "check",
    "embed",
    "find_rest_shape",
    "fit",
    "fit_relaxation",
    "fit_scenes",
    "gradient",
    "laws",
    "num_threads",
    "parameter_names",
    "picture",
    "read_mesh",
    "read_sweep",
    "run",
    "set_num_threads",
    "sweep",
    "value_and_gradient",
]
