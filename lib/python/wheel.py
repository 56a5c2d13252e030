"""Builds the wheel: wheel.py PACKAGE LIBRARIES DECLARATIONS VERSION OUT.whl

PACKAGE is lib/python/geotex, LIBRARIES a folder of shared objects, DECLARATIONS the C headers after
the preprocessor. cffi turns these into a Python module, so that importing needs neither headers
nor a compiler, and no version of Python is bound. The same input gives the same bytes."""

import base64
import hashlib
import io
import os
import sys
import sysconfig
import tempfile
import zipfile

import cffi

METADATA = """Metadata-Version: 2.1
Name: geotex
Version: {version}
Summary: Geometry textures: finely tessellated models as oriented height maps
License: MIT
Requires-Python: >=3.9
Requires-Dist: cffi>=1.15
Requires-Dist: numpy>=1.20

{readme}"""

WHEEL = """Wheel-Version: 1.0
Generator: geotex
Root-Is-Purelib: false
Tag: {tag}
"""


def declarations(path):
    """A module of Python with what the C headers declare."""
    builder = cffi.FFI()
    with open(path) as file:
        builder.cdef(file.read() + "\nvoid free(void *memory);\n")
    builder.set_source("geotex._declarations", None)
    with tempfile.TemporaryDirectory() as folder:
        with open(builder.compile(tmpdir=folder), "rb") as file:
            return file.read()


def files_of(folder):
    for name in sorted(os.listdir(folder)):
        path = os.path.join(folder, name)
        if os.path.isfile(path):
            with open(path, "rb") as file:
                yield name, file.read()


def main(package, libraries, headers, version, out):
    tag = "py3-none-" + sysconfig.get_platform().replace("-", "_").replace(".", "_")
    info = f"geotex-{version}.dist-info/"
    with open(os.path.join(os.path.dirname(package), "README.md")) as file:
        readme = file.read()
    content = {"geotex/" + name: data for name, data in files_of(package)}
    content["geotex/_declarations.py"] = declarations(headers)
    content.update(("geotex/lib/" + name, data) for name, data in files_of(libraries))
    content[info + "METADATA"] = METADATA.format(version=version, readme=readme).encode()
    content[info + "WHEEL"] = WHEEL.format(tag=tag).encode()
    record = io.StringIO()
    for name, data in content.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        record.write(f"{name},sha256={digest},{len(data)}\n")
    record.write(info + "RECORD,,\n")
    content[info + "RECORD"] = record.getvalue().encode()
    with zipfile.ZipFile(out + ".part", "w", zipfile.ZIP_DEFLATED) as wheel:
        for name, data in content.items():
            entry = zipfile.ZipInfo(name)  # of 1980: no time of today's
            entry.external_attr = (0o100755 if name.startswith("geotex/lib/") else 0o100644) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            wheel.writestr(entry, data)
    os.replace(out + ".part", out)


main(*sys.argv[1:])
