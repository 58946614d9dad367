"""The SBOM of the built program: sbom.py SOURCE PROGRAM. It is as SPDX 2.3 has it, and names what the program loads and is
built with."""

import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

LICENCE = r"[A-Za-z0-9.+-]+"  # an identifier of SPDX
EXPRESSION = re.compile(rf"{LICENCE}( (AND|OR|WITH) {LICENCE})*")


def main(source, program):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "fjr.spdx.json"
        subprocess.run([sys.executable, source / "scripts" / "sbom.py", program, file], check=True)
        document = json.loads(file.read_text())
    assert document["spdxVersion"] == "SPDX-2.3" and document["dataLicense"] == "CC0-1.0"
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", document["creationInfo"]["created"])
    packages = {package["SPDXID"]: package for package in document["packages"]}
    assert len(packages) == len(document["packages"]), "two packages have one SPDXID"
    for package in packages.values():
        assert re.fullmatch(r"SPDXRef-[A-Za-z0-9.-]+", package["SPDXID"]), package
        assert package["versionInfo"], package
        assert EXPRESSION.fullmatch(package["licenseDeclared"]), package
    named = {"SPDXRef-DOCUMENT", *packages}
    related = {(a["spdxElementId"], a["relationshipType"], a["relatedSpdxElement"]) for a in document["relationships"]}
    assert all(a in named and b in named for a, _, b in related)
    loaded = {packages[b]["name"] for a, kind, b in related if kind == "DEPENDS_ON"}
    assert any("ipopt" in name for name in loaded) and any("sundials-arkode" in name for name in loaded), loaded
    built = {packages[a]["name"]: packages[a]["licenseDeclared"] for a, kind, _ in related if kind == "BUILD_DEPENDENCY_OF"}
    assert built["libcli11-dev"] == "BSD-3-Clause", built  # headers alone: nothing is loaded
    assert "NOASSERTION" not in built.values(), built


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
