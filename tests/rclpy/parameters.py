"""The parameter services of a node, called with plain values."""

from types import SimpleNamespace
from typing import Any

# rcl_interfaces/ParameterType: number and field of the value.
NOT_SET = 0
BOOL, INTEGER, DOUBLE, STRING, STRINGS = 1, 2, 3, 4, 9
FIELDS = {
    BOOL: "bool_value",
    INTEGER: "integer_value",
    DOUBLE: "double_value",
    STRING: "string_value",
    STRINGS: "string_array_value",
}
OF_PYTHON = {bool: BOOL, int: INTEGER, float: DOUBLE, str: STRING, list: STRINGS}


def as_value(value: Any) -> dict:
    number = OF_PYTHON[type(value)]
    return {"type": number, FIELDS[number]: value}


def as_plain(value: Any) -> Any:
    return None if value.type == NOT_SET else getattr(value, FIELDS[value.type])


class ParameterClient:
    def __init__(self, ros, node_name: str):
        self.ros = ros
        self.node_name = node_name

    def call(self, service: str, type_name: str, **request) -> SimpleNamespace:
        return self.ros.call(f"{self.node_name}/{service}", f"rcl_interfaces/srv/{type_name}", request)

    def listed(self, *prefixes: str, depth: int = 0) -> SimpleNamespace:
        return self.call("list_parameters", "ListParameters", prefixes=list(prefixes), depth=depth).result

    def get(self, *names: str) -> list:
        answer = self.call("get_parameters", "GetParameters", names=list(names))
        return [as_plain(value) for value in answer.values]

    def types(self, *names: str) -> list[int]:
        return self.call("get_parameter_types", "GetParameterTypes", names=list(names)).types

    def describe(self, *names: str) -> list:
        return self.call("describe_parameters", "DescribeParameters", names=list(names)).descriptors

    def set_each(self, values: dict) -> list:
        """One result for each."""
        return self.call("set_parameters", "SetParameters", parameters=as_parameters(values)).results

    def set_together(self, values: dict) -> SimpleNamespace:
        """All of them or none."""
        parameters = as_parameters(values)
        return self.call("set_parameters_atomically", "SetParametersAtomically", parameters=parameters).result


def as_parameters(values: dict) -> list[dict]:
    return [{"name": name, "value": as_value(value)} for name, value in values.items()]
