"""The OpenGL context and the shaders: what has to exist before anything can be drawn."""

from __future__ import annotations

from functools import cache
from importlib import resources

import moderngl

from ..errors import SimulationError

EGL_HELP = (
    "the light renderer needs OpenGL 3.3 through EGL, and no EGL context could be made ({reason}); "
    "on Debian and Ubuntu install the packages libegl1 and libgl1-mesa-dri"
)
GLSL_VERSION = "#version 330 core"
INCLUDE = "#include "


def open_context() -> moderngl.Context:
    """A context without a window; raises SimulationError where the machine has no EGL."""
    try:
        context = moderngl.create_standalone_context(backend="egl", require=330)
    except Exception as error:  # glcontext raises bare Exception, OSError and ImportError alike
        raise SimulationError(EGL_HELP.format(reason=str(error) or type(error).__name__)) from error
    return context


@cache
def _source(name: str) -> str:
    text = resources.files(__package__).joinpath("shaders", name).read_text(encoding="utf-8")
    lines = []
    for line in text.splitlines():
        lines.append(_source(line[len(INCLUDE):].strip().strip('"')) if line.startswith(INCLUDE) else line)
    return "\n".join(lines)


def shader_source(name: str, defines: tuple[tuple[str, int], ...] = ()) -> str:
    """The text of a shader file with its includes put in, after the version line and `defines`."""
    head = [GLSL_VERSION, *(f"#define {key} {value}" for key, value in defines)]
    return "\n".join([*head, _source(name)])


def build_program(
    context: moderngl.Context, vertex: str, fragment: str, defines: tuple[tuple[str, int], ...] = ()
) -> moderngl.Program:
    """A program from two files of the shaders folder."""
    return context.program(
        vertex_shader=shader_source(vertex, defines), fragment_shader=shader_source(fragment, defines)
    )


def set_uniforms(program: moderngl.Program, values: dict[str, object]) -> None:
    """Sets the uniforms that the program has kept; the compiler drops those that it does not need."""
    for name, value in values.items():
        if name in program:
            member = program[name]
            if isinstance(value, bytes):
                member.write(value)
            else:
                member.value = value
