"""One way to drive an FMU of either version through FMPy, and the library through ctypes, by names of variables."""

import ctypes
import shutil
import struct
import threading

import fmpy
from fmpy import fmi2, fmi3


def bits(value):
    """A float as the integer that its bits are: comparisons are of bits."""
    return struct.unpack("<Q", struct.pack("<d", value))[0]


class Fmu:
    """An instance of an FMU that is driven call by call."""

    def __init__(self, path, logging=True):
        self.description = fmpy.read_model_description(path)
        self.version = int(self.description.fmiVersion[0])
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.folder = fmpy.extract(path)
        self.messages = []
        self.logging_threads = set()
        arguments = dict(
            guid=self.description.guid if self.version == 2 else self.description.instantiationToken,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="instance",
        )
        if self.version == 2:
            self.fmu = fmi2.FMU2Slave(**arguments)
            self.callbacks = fmi2.fmi2CallbackFunctions()
            self.callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(self.log2)
            self.callbacks.componentEnvironment = 4711
            self.fmu.instantiate(callbacks=self.callbacks, loggingOn=logging)
        else:
            self.fmu = fmi3.FMU3Slave(**arguments)
            self.fmu.instantiate(loggingOn=logging, logMessage=self.log3)

    def log2(self, environment, name, status, category, message, *_):
        assert environment == 4711 and name == b"instance"
        self.logging_threads.add(threading.get_native_id())
        self.messages.append((status, category.decode(), message.decode()))

    def log3(self, environment, status, category, message):
        self.logging_threads.add(threading.get_native_id())
        self.messages.append((status, category.decode(), message.decode()))

    def initialize(self, stop=None, **start_values):
        if self.version == 2:
            self.fmu.setupExperiment(startTime=0.0, stopTime=stop)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=0.0, stopTime=stop)
        for name, value in start_values.items():
            self.set(name.replace("__", "."), value)
        self.fmu.exitInitializationMode()
        return self

    def access(self, action, kind):
        name = {"Enumeration": "Integer"}.get(kind, kind) if self.version == 2 else {"Enumeration": "Int64"}.get(kind, kind)
        return getattr(self.fmu, action + name)

    def set(self, name, value):
        variable = self.variables[name]
        self.access("set", variable.type)([variable.valueReference], [value])

    def get(self, names):
        values = []
        for name in names:
            variable = self.variables[name]
            values += self.access("get", variable.type)([variable.valueReference])
        return [float(v) for v in values]

    def step(self, t, h):
        self.fmu.doStep(currentCommunicationPoint=t, communicationStepSize=h)

    def reset(self):
        self.fmu.reset()

    def get_state(self):
        return self.fmu.getFMUstate() if self.version == 2 else self.fmu.getFMUState()

    def set_state(self, state):
        self.fmu.setFMUstate(state) if self.version == 2 else self.fmu.setFMUState(state)

    def free_state(self, state):
        self.fmu.freeFMUstate(state) if self.version == 2 else self.fmu.freeFMUState(state)

    def save(self):
        state = self.get_state()
        saved = self.fmu.serializeFMUstate(state) if self.version == 2 else self.fmu.serializeFMUState(state)
        self.free_state(state)
        return bytes(saved)

    def restore(self, saved):
        if self.version == 2:
            state = self.fmu.deSerializeFMUstate(saved)
        else:
            state = self.fmu.deserializeFMUState(saved)
        self.set_state(state)
        self.free_state(state)

    def free(self):
        self.fmu.freeInstance()
        shutil.rmtree(self.folder)


class Row(ctypes.Structure):
    """sandgate_variable."""

    _fields_ = (
        [(name, ctypes.c_char_p) for name in ("name", "description", "unit", "display_unit")]
        + [(name, ctypes.c_double) for name in ("display_factor", "minimum", "maximum")]
        + [("length", ctypes.c_uint64), ("reference", ctypes.c_uint32)]
        + [(n, ctypes.c_int32) for n in ("causality", "variability", "kind", "has_start", "is_element")]
        + [("element_of", ctypes.c_uint32), ("element_index", ctypes.c_uint32)]
    )


class Library:
    """The plain C interface, through ctypes."""

    def __init__(self, path, scene):
        self.lib = ctypes.CDLL(path)
        self.lib.sandgate_create_from_file.restype = ctypes.c_void_p
        self.lib.sandgate_last_error.restype = ctypes.c_char_p
        error = ctypes.create_string_buffer(4000)
        made = self.lib.sandgate_create_from_file(scene.encode(), error, ctypes.c_size_t(len(error)))
        assert made, error.value.decode()
        self.handle = ctypes.c_void_p(made)
        self.references = {}
        for reference in range(self.lib.sandgate_variable_count(self.handle)):
            row = Row()
            self.check(self.lib.sandgate_variable_info(self.handle, reference, ctypes.byref(row)))
            self.references[row.name.decode()] = reference

    def check(self, status):
        assert status == 0, (status, self.lib.sandgate_last_error(self.handle).decode())

    def initialize(self, stop=float("inf"), threads=1):
        self.check(self.lib.sandgate_set_threads(self.handle, threads))
        self.check(self.lib.sandgate_initialize(self.handle, ctypes.c_double(0.0), ctypes.c_double(stop)))
        return self

    def set(self, name, value):
        reference, number = ctypes.c_uint32(self.references[name]), ctypes.c_double(value)
        one = ctypes.c_size_t(1)
        self.check(self.lib.sandgate_set(self.handle, ctypes.byref(reference), one, ctypes.byref(number), one))

    def get(self, names):
        count = len(names)
        references = (ctypes.c_uint32 * count)(*[self.references[name] for name in names])
        values = (ctypes.c_double * count)()
        size = ctypes.c_size_t(count)
        self.check(self.lib.sandgate_get(self.handle, references, size, values, size))
        return list(values)

    def step(self, t, h):
        self.check(self.lib.sandgate_step(self.handle, ctypes.c_double(t), ctypes.c_double(h), None))

    def free(self):
        self.lib.sandgate_free(self.handle)
