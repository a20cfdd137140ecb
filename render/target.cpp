#include "render/target.hpp"

#include <fmt/format.h>

#include <initializer_list>

#include "core/model/error.hpp"

namespace planescope::render {
namespace {

struct Attachment {
  GLenum point = GL_COLOR_ATTACHMENT0;
  GLuint renderbuffer = 0;
};

GlRenderbuffer storage(int samples, GLenum format, int width, int height) {
  GlRenderbuffer buffer = make_renderbuffer();
  glBindRenderbuffer(GL_RENDERBUFFER, buffer);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
  return buffer;
}

GlTexture texture(GLint format, GLenum channels, int width, int height) {
  GlTexture result = make_texture();
  glBindTexture(GL_TEXTURE_2D, result);
  glTexImage2D(GL_TEXTURE_2D, 0, format, width, height, 0, channels, GL_UNSIGNED_INT, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  return result;
}

GlFramebuffer framebuffer(std::initializer_list<Attachment> attachments) {
  GlFramebuffer result = make_framebuffer();
  glBindFramebuffer(GL_FRAMEBUFFER, result);
  for (const Attachment& attachment : attachments) {
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachment.point, GL_RENDERBUFFER,
                              attachment.renderbuffer);
  }
  return result;
}

void check_complete(const char* what, int width, int height) {
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status == GL_FRAMEBUFFER_COMPLETE) return;
  throw Error(fmt::format("OpenGL cannot draw a {} of {} x {} pixels (framebuffer status {:#x})",
                          what, width, height, status));
}

void check_size(int width, int height) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
  if (width >= 1 && height >= 1 && width <= largest && height <= largest) return;
  throw Error(fmt::format("a picture of {} x {} pixels was asked for, expected 1 to {} each way",
                          width, height, largest));
}

}  // namespace

void SceneTarget::resize(int new_width, int new_height) {
  if (new_width == width && new_height == height) return;
  check_size(new_width, new_height);
  width = 0;  // until all of it stands
  color = storage(samples, GL_RGBA8, new_width, new_height);
  depth = storage(samples, GL_DEPTH_COMPONENT24, new_width, new_height);
  box_depth = storage(samples, GL_DEPTH_COMPONENT24, new_width, new_height);
  scene = framebuffer({{GL_COLOR_ATTACHMENT0, color}, {GL_DEPTH_ATTACHMENT, depth}});
  check_complete("picture", new_width, new_height);
  boxes = framebuffer({{GL_COLOR_ATTACHMENT0, color}, {GL_DEPTH_ATTACHMENT, box_depth}});
  check_complete("picture", new_width, new_height);

  flat_depth = texture(GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, new_width, new_height);
  flat_color = texture(GL_RGBA8, GL_RGBA, new_width, new_height);
  // Blending leaves the alpha channel with values that mean nothing.
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_A, GL_ONE);
  glBindTexture(GL_TEXTURE_2D, 0);
  resolved = framebuffer({});
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, flat_color, 0);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, flat_depth, 0);
  check_complete("picture", new_width, new_height);
  width = new_width;
  height = new_height;
}

void IdTarget::resize(int new_width, int new_height) {
  if (new_width == width && new_height == height) return;
  check_size(new_width, new_height);
  width = 0;
  ids = storage(0, GL_R32UI, new_width, new_height);
  depth = storage(0, GL_DEPTH_COMPONENT24, new_width, new_height);
  framebuffer =
      planescope::render::framebuffer({{GL_COLOR_ATTACHMENT0, ids}, {GL_DEPTH_ATTACHMENT, depth}});
  check_complete("picking buffer", new_width, new_height);
  width = new_width;
  height = new_height;
}

}  // namespace planescope::render
