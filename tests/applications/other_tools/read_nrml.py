"""The probabilities that OpenQuake works out of a fragility model, as JSON: python read_nrml.py
FILE X,X,...

{imt, id, states: {limit state: probabilities at the intensities X}}.
"""

import json
import sys

import numpy
from openquake.hazardlib import nrml
from openquake.risklib import read_nrml

read_nrml.update_validators()
model = nrml.to_python(sys.argv[1])
x = numpy.array([float(word) for word in sys.argv[2].split(",")])
(((imt, name), functions),) = model.items()
built = functions.build(model.limitStates)
print(
    json.dumps(
        {
            "imt": imt,
            "id": name,
            "states": {state: one(x).tolist() for state, one in zip(model.limitStates, built)},
        }
    )
)
