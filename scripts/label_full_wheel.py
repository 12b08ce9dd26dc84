"""Give the wheel with SuiteSparse its own version and licence: python scripts/label_full_wheel.py FOLDER.

The wheel in the folder is replaced. Its version gets the local part `+suitesparse`, which PyPI does not
accept. Its licence becomes the GPL; licence texts of the libraries that will be copied into it are added.
"""

import re
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

LOCAL = "suitesparse"
LICENCE = "GPL-3.0-or-later"
OF_THE_SYSTEM = ("libc.so", "libm.so", "libstdc++.so", "libgcc_s.so", "libpthread.so", "libdl.so", "librt.so")


def relabelled(metadata: str) -> str:
    """Return the metadata with the local version and the licence of the whole."""
    version = re.sub(r"^(Version: [\w.]+)$", rf"\1+{LOCAL}", metadata, count=1, flags=re.M)
    return re.sub(r"^License-Expression: .*$", f"License-Expression: {LICENCE}", version, count=1, flags=re.M)


def licence_texts(module: Path) -> dict[str, str]:
    """Return the licence texts of the libraries of a module, by Debian package."""
    listed = subprocess.run(["ldd", module], capture_output=True, text=True, check=True).stdout
    texts = {}
    for place in re.findall(r"=> (\S+)", listed):
        if Path(place).name.startswith(OF_THE_SYSTEM):
            continue
        command = ["dpkg", "-S", f"*/{Path(place).resolve().name}"]
        owner = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split(":")[0]
        texts[owner] = Path(f"/usr/share/doc/{owner}/copyright").read_text(encoding="utf-8")
    return texts


def label(wheel: Path) -> None:
    """Replace a wheel by the labelled one."""
    with TemporaryDirectory() as scratch:
        subprocess.run([sys.executable, "-m", "wheel", "unpack", "--dest", scratch, wheel], check=True)
        (root,) = Path(scratch).iterdir()
        (plain,) = root.glob("*.dist-info")
        info = plain.rename(root / f"{plain.name.removesuffix('.dist-info')}+{LOCAL}.dist-info")
        metadata = info / "METADATA"
        text = relabelled(metadata.read_text(encoding="utf-8"))
        (module,) = root.rglob("_core.*.so")
        for package, licence in licence_texts(module).items():
            file = info / "licenses" / f"{package}.txt"
            file.write_text(licence, encoding="utf-8")
            text = text.replace(
                "License-File: LICENSE", f"License-File: LICENSE\nLicense-File: {file.name}", 1
            )
        metadata.write_text(text, encoding="utf-8")
        wheel.unlink()
        subprocess.run([sys.executable, "-m", "wheel", "pack", "--dest-dir", wheel.parent, root], check=True)


if __name__ == "__main__":
    (found,) = Path(sys.argv[1]).glob("flexarm-*.whl")
    label(found)
