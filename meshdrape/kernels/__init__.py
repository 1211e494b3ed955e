"""Compiled loops on plain arrays, and nothing else; the only place that imports numba.

Kernels trust their input: the classes that own the arrays check them once. They return codes, never raise.
"""

# Whether nobody but the kernels uses numba in this process, so that numba need not find BLAS, which they do not use and
# which takes longer to load than all of them. A command says so; a program that imports the package may want BLAS.
alone = False
