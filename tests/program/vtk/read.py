"""Prints nodes, cells, fields at nodes and fields in cells, as meshio finds them in a .vtu file."""

import sys

import meshio
import numpy


def show(name, values):
    print(name, " ".join(f"{value:.6f}" for value in numpy.ravel(values)))


mesh = meshio.read(sys.argv[1])
for point in mesh.points:
    show("node", point)
for block in mesh.cells:
    for cell in block.data:
        show(block.type, cell)
for name, values in mesh.point_data.items():
    show(name, values)
for name, blocks in mesh.cell_data.items():
    show(name, numpy.concatenate(blocks))
