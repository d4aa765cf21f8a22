"""tomllib, which Python 3.10 lacks; pytest brings its twin along there."""

try:
    import tomllib
except ImportError:
    import tomli as tomllib

__all__ = ["tomllib"]
