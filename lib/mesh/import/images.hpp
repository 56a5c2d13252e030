/* From encoded images to those of an appearance. Internal to lib/mesh. */
#pragma once

#include "mesh/import/import.hpp"

#include <functional>

namespace gtx {

/* An image as a file or a buffer holds it. */
struct EncodedImage {
    std::string name;      /* for messages: "image 3 ('wood.png')" */
    Bytes bytes;
    std::string problem;   /* why there are none */
    float glossiness = -1; /* >= 0: the alpha holds glossiness, to be multiplied by this; it becomes
                            * roughness where a metal-rough map has that */
    float bump = 0;        /* > 0: heights, if it is grey, which become normals; or normals; the
                            * slopes times this */
    bool opacity = false;  /* its alpha, or its grey where it has none, in all channels */
    bool required = false; /* without it nothing is made: Error READ */
};

/* The bytes of a file that a model names, or the problem. Throws Error: LIMIT. */
EncodedImage read_image_file(const ModelFile &file, std::string name, const std::string &path,
                             Task &task);

/* Materials whose base colour has no texture, or one that cannot be read, get the image that the
 * caller gave for that, if any; `encoded` holds the images that they name. Throws Error: LIMIT. */
void add_base_color(const ModelFile &file, Appearance &look, Vector<EncodedImage> &encoded,
                    Task &task);

/* Decodes those images that textures of `look` name (Texture::image is an index of `encoded`), each
 * once, and makes the textures name the results. An image that cannot be had is a warning, and the
 * textures that name it are gone: their factors alone are left, but nothing shines by a factor that
 * waited for its texture. Coordinates and tangents that no texture looks at go too. */
void load_images(const Vector<EncodedImage> &encoded, Appearance &look, Task &task);

/* The same of images that `encoded` reads when it is asked, one after another: each is given to
 * `sink` and to nobody else. */
void stream_images(size_t count, const std::function<EncodedImage(size_t)> &encoded,
                   const std::function<void(Image)> &sink, Appearance &look, Task &task);

} // namespace gtx
