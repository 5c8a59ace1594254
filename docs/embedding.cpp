// Lightloom inside a program that has its own OpenGL context: the program hands in a texture as one of the graph's
// inputs and gets the picture back as a texture. Nothing here needs a window; a program that has one calls the same.
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <cstdio>
#include <vector>

#include "loom/lightloom.h"

namespace {

// The program's own business: any current 4.5 core context will do.
EGLContext make_context(EGLDisplay& display) {
  display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (!eglInitialize(display, nullptr, nullptr) || !eglBindAPI(EGL_OPENGL_API)) return EGL_NO_CONTEXT;
  const EGLint wanted[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_NONE};
  const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted);
  return eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) ? context : EGL_NO_CONTEXT;
}

// The direct light of the shipped passes, and as indirect light whatever the program supplies as `inputs.ambient`.
constexpr const char* pipeline = R"({
  "name": "embedded",
  "inputs": { "ambient": { "type": "Irradiance", "format": "rgba16f" } },
  "passes": {
    "gbuffer":   { "type": "GBuffer" },
    "rsm":       { "type": "RSM" },
    "direct":    { "type": "DirectLight", "in": { "surface": "gbuffer.surface", "lights": "rsm.lights" } },
    "composite": { "type": "Composite", "in": { "surface": "gbuffer.surface", "direct": "direct.irradiance",
                                                "indirect": "inputs.ambient" } },
    "tonemap":   { "type": "Tonemap", "in": { "hdr": "composite.radiance" } }
  },
  "outputs": { "image": "tonemap.image", "hdr": "composite.radiance" }
})";

double mean_of(const loom::OutputTexture& output) {
  std::vector<float> texels(static_cast<std::size_t>(output.desc.width) * static_cast<std::size_t>(output.desc.height) *
                            4);
  glGetTextureImage(output.texture, 0, GL_RGBA, GL_FLOAT, static_cast<GLsizei>(texels.size() * sizeof(float)),
                    texels.data());
  double sum = 0;
  for (std::size_t i = 0; i < texels.size(); i += 4) sum += texels[i];
  return sum / (static_cast<double>(texels.size()) / 4);
}

}  // namespace

int main() try {
  EGLDisplay display = EGL_NO_DISPLAY;
  const EGLContext context = make_context(display);
  if (context == EGL_NO_CONTEXT) return std::puts("no OpenGL 4.5 context here"), 77;
  {
    const auto desc = loom::TextureDesc::image({128, 128}, loom::Format::rgba16f);
    GLuint ambient = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &ambient);
    glTextureStorage2D(ambient, 1, GL_RGBA16F, desc.width, desc.height);

    loom::Session session = loom::Session::open();
    session.load_scene("");  // the built-in Cornell box
    session.load_pipeline(pipeline, {.size = {desc.width, desc.height}});
    session.set_input("ambient", "irradiance", ambient, desc);
    for (const float irradiance : {0.f, 1.f, 2.f}) {  // W/m²
      const float rgba[] = {irradiance, irradiance, irradiance, 1};
      glClearTexImage(ambient, 0, GL_RGBA, GL_FLOAT, rgba);
      session.render();
      std::printf("ambient %.0f W/m2: mean radiance %.6f W/(m2 sr)\n", irradiance, mean_of(session.output("hdr")));
    }
    glDeleteTextures(1, &ambient);
  }
  eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display, context);
  return 0;
} catch (const loom::Error& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
