"""Prints a parameter of a node, as a double.

    get_parameter.py /left/reorder timing.rate_hz
"""

import sys

from rcl_interfaces.srv import GetParameters

from conversation import call, run
from leave import leave


def converse(node):
    request = GetParameters.Request(names=[sys.argv[2]])
    print(call(node, GetParameters, f"{sys.argv[1]}/get_parameters", request).values[0].double_value)


if __name__ == "__main__":
    leave(run(converse, "reader"))
