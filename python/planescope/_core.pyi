# What planescope/__init__.py shows of the compiled module; the rest is its own affair.
from typing import Any

__version__: str

class Error(ValueError): ...

def __getattr__(name: str) -> Any: ...
