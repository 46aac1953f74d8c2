"""What the tests share: a daemon of a few lines on a real socket, and an empty Blender."""

from __future__ import annotations

import pytest
from daemons import Daemon

try:
    import bpy
except ImportError as error:
    bpy = None
    REASON = str(error)
else:
    REASON = ""


def pytest_collection_modifyitems(items) -> None:
    """Skips what needs Blender where there is none, and says so loudly."""
    for item in items:
        if "blender" in item.fixturenames and bpy is None:
            item.add_marker(pytest.mark.skip(reason=f"BLENDER IS NOT TESTED: {REASON}"))


@pytest.fixture
def blender():
    """An empty file of Blender's: its scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return bpy.context.scene


@pytest.fixture
def daemon():
    made = Daemon()
    yield made
    made.close()
