/* Viewpoints to measure from: keys of a file, or random ones around a model. */
#pragma once

#include "mesh/mesh.hpp"

namespace gtx {

/* In the model's own coordinates. */
struct Viewpoint {
    Vec3d eye, target;
};

struct ViewPath {
    Vec3d up = {0, 1, 0};
    double field = 45;        /* of view, vertical; degrees */
    Vector<Viewpoint> views;
};

/* Reads a text of one key a line, "x y z x y z", the eye and what it looks at, with lines "up x y
 * z" and "fov DEGREES" before the first; # begins a comment. `count` views are spread evenly over
 * the lines from key to key; 0: the keys themselves. Throws Error: READ, INPUT, LIMIT, MEMORY. */
ViewPath read_path(const std::string &file, uint32_t count, Task &task);

/* Views in turn from outside, from just above the surface along it, and from anywhere in the box
 * around the mesh, the same ones for the same mesh and seed. */
ViewPath random_path(const Mesh &mesh, uint32_t count, uint32_t seed);

/* As the first lines of a file, and as one of its keys; without line ends. */
std::string path_head(const ViewPath &path);
std::string path_key(const Viewpoint &view);

} // namespace gtx
