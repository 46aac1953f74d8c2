"""Beside the package, so that pytest finds it wherever it is run from."""
