"""One FMU of either version, through FMPy, by names of variables: what the masters here need and no more."""

import shutil

import fmpy
from fmpy import fmi2, fmi3


class Slave:
    """An instance, initialised at t = 0."""

    def __init__(self, path, **start_values):
        self.description = fmpy.read_model_description(path)
        self.two = self.description.fmiVersion.startswith("2")
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        self.folder = fmpy.extract(path)
        kind = fmi2.FMU2Slave if self.two else fmi3.FMU3Slave
        self.fmu = kind(
            guid=self.description.guid if self.two else self.description.instantiationToken,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=self.description.modelName,
        )
        self.fmu.instantiate()
        if self.two:
            self.fmu.setupExperiment(startTime=0.0)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=0.0)
        for name, value in start_values.items():
            self.set(name, value)
        self.fmu.exitInitializationMode()

    def set(self, name, value):
        (self.fmu.setReal if self.two else self.fmu.setFloat64)([self.references[name]], [value])

    def get(self, name):
        return (self.fmu.getReal if self.two else self.fmu.getFloat64)([self.references[name]])[0]

    def step(self, t, h):
        self.fmu.doStep(currentCommunicationPoint=t, communicationStepSize=h)

    def save(self):
        return self.fmu.getFMUstate() if self.two else self.fmu.getFMUState()

    def restore(self, state):
        (self.fmu.setFMUstate if self.two else self.fmu.setFMUState)(state)

    def forget(self, state):
        (self.fmu.freeFMUstate if self.two else self.fmu.freeFMUState)(state)

    def free(self):
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)
