"""The light renderer: OpenGL through EGL, made for many pictures with exact ids on a plain CPU."""

from .renderer import LightRenderer

__all__ = ["LightRenderer"]
