"""Steps a silo through the plain C interface from Python's standard library alone: no package, no FMU.

    cargo build --release -p sandgate-fmu
    python examples/ctypes_silo.py target/release/libsandgate_fmu.so tests/scenes/small_silo.toml
"""

import ctypes
import math
import sys
from ctypes import POINTER, byref, c_char_p, c_double, c_int32, c_size_t, c_uint32, c_uint64, c_void_p

# `sandgate_logger`. Keep a reference for as long as the library may call it.
Logger = ctypes.CFUNCTYPE(None, c_void_p, c_char_p, c_char_p)


class Variable(ctypes.Structure):
    """`sandgate_variable`: a row of the table. Its texts belong to the instance."""

    _fields_ = (
        [(name, c_char_p) for name in ("name", "description", "unit", "display_unit")]
        + [(name, c_double) for name in ("display_factor", "minimum", "maximum")]
        + [("length", c_uint64), ("reference", c_uint32)]
        + [(name, c_int32) for name in ("causality", "variability", "kind", "has_start", "is_element")]
        + [("element_of", c_uint32), ("element_index", c_uint32)]
    )


def load(path):
    """The library with the types of the functions used here: ctypes passes everything else as int."""
    library = ctypes.CDLL(path)
    declare = {
        "abi_version": (c_uint32, []),
        "version": (c_char_p, []),
        "create_from_file": (c_void_p, [c_char_p, c_char_p, c_size_t]),
        "free": (None, [c_void_p]),
        "last_error": (c_char_p, [c_void_p]),
        "set_logger": (c_int32, [c_void_p, Logger, c_void_p]),
        "set_threads": (c_int32, [c_void_p, c_uint32]),
        "variable_count": (c_uint32, [c_void_p]),
        "variable_info": (c_int32, [c_void_p, c_uint32, POINTER(Variable)]),
        "initialize": (c_int32, [c_void_p, c_double, c_double]),
        "set": (c_int32, [c_void_p, POINTER(c_uint32), c_size_t, POINTER(c_double), c_size_t]),
        "get": (c_int32, [c_void_p, POINTER(c_uint32), c_size_t, POINTER(c_double), c_size_t]),
        "step": (c_int32, [c_void_p, c_double, c_double, c_void_p]),
        "save_size": (c_int32, [c_void_p, POINTER(c_size_t)]),
        "save": (c_int32, [c_void_p, c_char_p, c_size_t, POINTER(c_size_t)]),
        "restore": (c_int32, [c_void_p, c_char_p, c_size_t]),
    }
    for name, (result, arguments) in declare.items():
        function = getattr(library, "sandgate_" + name)
        function.restype, function.argtypes = result, arguments
    if library.sandgate_abi_version() != 1:
        sys.exit(f"this program is for interface 1, the library has {library.sandgate_abi_version()}")
    return library


class Silo:
    """An instance. Refused calls raise with the library's own words."""

    def __init__(self, library, scene):
        self.library = library
        error = ctypes.create_string_buffer(4096)
        self.handle = library.sandgate_create_from_file(scene.encode(), error, len(error))
        if not self.handle:
            raise ValueError(error.value.decode())
        self.references = {}
        for reference in range(library.sandgate_variable_count(self.handle)):
            row = Variable()
            self.call("variable_info", reference, byref(row))
            self.references[row.name.decode()] = reference

    def call(self, name, *arguments):
        if getattr(self.library, "sandgate_" + name)(self.handle, *arguments) != 0:
            raise RuntimeError(self.library.sandgate_last_error(self.handle).decode())

    def set(self, **values):
        """Inputs by name, with __ for each dot: all of them, or none."""
        names = [name.replace("__", ".") for name in values]
        references = (c_uint32 * len(names))(*[self.references[name] for name in names])
        numbers = (c_double * len(names))(*values.values())
        self.call("set", references, len(names), numbers, len(names))

    def get(self, *names):
        references = (c_uint32 * len(names))(*[self.references[name] for name in names])
        values = (c_double * len(names))()
        self.call("get", references, len(names), values, len(names))
        return list(values)

    def save(self):
        size = c_size_t()
        self.call("save_size", byref(size))
        room = ctypes.create_string_buffer(size.value)
        self.call("save", room, len(room), byref(size))
        return room.raw[: size.value]

    def restore(self, state):
        self.call("restore", state, len(state))

    def free(self):
        self.library.sandgate_free(self.handle)
        self.handle = None


def run(silo, first, last, h=0.01):
    """Steps, and says what came out."""
    for k in range(first, last):
        silo.call("step", k * h, (k + 1) * h - k * h, None)
        level, rate = silo.get("gauge.level.depth", "outflow.drain.rate")
        print(f"t {(k + 1) * h:.2f} s   level {1000 * level:5.1f} mm   outflow {rate:6.2f} kg/s")
    return silo.get("mass.present", "gauge.level.depth")


def main(library, scene):
    library = load(library)
    silo = Silo(library, scene)
    print(f"Sandgate {library.sandgate_version().decode()}: {len(silo.references)} variables")
    messages = []
    logger = Logger(lambda user, category, message: messages.append((category.decode(), message.decode())))
    silo.call("set_logger", logger, None)
    silo.call("set_threads", 2)
    silo.call("initialize", 0.0, math.inf)
    silo.set(gate__main__opening=1.0)
    run(silo, 0, 5)
    state = silo.save()
    first = run(silo, 5, 10)
    silo.restore(state)
    second = run(silo, 5, 10)
    try:
        silo.set(gate__main__opening=1.5)
    except RuntimeError as refusal:
        print("refused:", refusal)
    print(f"{len(messages)} messages, the last: {messages[-1]}")
    silo.free()
    if first != second:
        sys.exit(f"the same steps from the same state gave {first} and {second}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
