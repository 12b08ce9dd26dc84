"""The scripts of the examples as modules, imported as they are when they run: beside their siblings."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def load_script(example: str, name: str) -> ModuleType:
    folder = EXAMPLES / example
    spec = importlib.util.spec_from_file_location(f"{example}_{name}", folder / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    sys.path.insert(0, str(folder))
    try:
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(folder))
        for sibling in [name for name, each in sys.modules.items() if _is_beside(each, folder)]:
            del sys.modules[sibling]  # other examples have modules of the same names
    return module


def _is_beside(module: ModuleType, folder: Path) -> bool:
    file = getattr(module, "__file__", None)
    return file is not None and Path(file).parent == folder
