# What ci/images has prepared takes the places of the stages that would fetch it: a second file beside docker-bake.hcl.
target "image" {
  contexts = {
    base     = "docker-image://localhost/laserbot/base:trixie"
    packages = "build/packages"
    page     = "server/static/bundle"
  }
}
