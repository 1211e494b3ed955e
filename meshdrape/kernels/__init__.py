"""Compiled loops on plain arrays, and nothing else; the only place that imports numba.

Kernels trust their input: the classes that own the arrays check them once. They return codes, never raise.
"""
