"""Checks the meshes of a pressed pad, as meshio reads them, in the folder that is named."""

import sys

import meshio
import numpy

plate = meshio.read(f"{sys.argv[1]}/plate.vtu")
down = plate.point_data["displacement_mm"]
assert numpy.allclose(plate.points[:, 2], 0)
assert numpy.isclose(numpy.hypot(*plate.points[:, :2].T).max(), 30)
for index, angle in enumerate(numpy.radians([0, 120, 240])):
    module = meshio.read(f"{sys.argv[1]}/module{index}.vtu")
    places, moved = module.points, module.point_data["displacement_mm"]
    bricks = module.cells_dict["hexahedron20"]
    corner, *along = (places[bricks[:, node]] for node in (0, 1, 3, 4))
    a, b, c = (end - corner for end in along)
    assert (numpy.einsum("ij,ij->i", numpy.cross(a, b), c) > 0).all(), "a brick is inside out"
    centre = places[:, :2].min(0) / 2 + places[:, :2].max(0) / 2
    assert numpy.allclose(centre, [20 * numpy.cos(angle), 20 * numpy.sin(angle)], atol=0.01), centre
    top, base = places[:, 2].max(), places[:, 2].min()
    assert numpy.isclose(top, -1), "modules hang under the plate"
    assert (moved[places[:, 2] < base + 1e-9] == 0).all(), "the base holds"
    foot = moved[places[:, 2] > top - 1e-9][:, 2].mean()
    near = numpy.hypot(*(plate.points[:, :2] - centre).T) < 2
    above = down[near][:, 2].mean()
    assert abs(foot - above) < 0.05 * abs(down[:, 2]).max(), (foot, above)
    stress = numpy.ravel(module.cell_data["von_mises_mpa"][0])
    assert (stress >= 0).all() and stress.max() > 0.01
    assert set(numpy.ravel(module.cell_data["layer"][0])) == {0, 1, 2, 3, 4, 5}
