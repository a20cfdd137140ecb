#include "render/image_texture.hpp"

#include <cassert>

namespace planescope::render {

void ImageTexture::upload(const Image8& image) {
  assert(!image.empty() && (image.channels == 3 || image.channels == 4));
  GLint before = 0;
  glGetIntegerv(GL_TEXTURE_BINDING_2D, &before);
  const bool same = width_ == image.width && height_ == image.height && channels_ == image.channels;
  if (texture_ == 0) texture_ = make_texture();
  glBindTexture(GL_TEXTURE_2D, texture_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  const GLenum channels = image.channels == 3 ? GL_RGB : GL_RGBA;
  if (same) {
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, image.width, image.height, channels, GL_UNSIGNED_BYTE,
                    image.data.data());
  } else {
    glTexImage2D(GL_TEXTURE_2D, 0, image.channels == 3 ? GL_RGB8 : GL_RGBA8, image.width,
                 image.height, 0, channels, GL_UNSIGNED_BYTE, image.data.data());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  }
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glBindTexture(GL_TEXTURE_2D, static_cast<GLuint>(before));
  width_ = image.width;
  height_ = image.height;
  channels_ = image.channels;
  check_gl("uploading an image");
}

}  // namespace planescope::render
