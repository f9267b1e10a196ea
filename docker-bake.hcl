# The images and their platforms.
#   docker buildx bake demo   what the demo needs, for this engine's own platform
#   docker buildx bake        all images for all platforms (an engine with containerd's image store)
#   ci/images                 the same on Debian, from what it has fetched outside of the build; lists what is inside
variable "VERSION" { default = "1.0.0" } # as compose.yaml asks for
variable "REVISION" { default = "" }
variable "SOURCE" { default = "" }
variable "SOURCE_DATE_EPOCH" { default = "0" } # of all that is made here: the same sources give the same images
# where Debian's packages come from, if not from where Debian's own image has them: images/fetch
variable "DEBIAN_MIRROR" { default = "" }
variable "DEBIAN_SECURITY_MIRROR" { default = "" }
variable "DEBIAN_SNAPSHOT" { default = "" }
variable "LOCKED" { default = "" }
# true: only for the platforms on which `make test` starts the images
variable "FEWER_PLATFORMS" { default = false }

group "default" { targets = ["webserver", "rosberry", "sim", "monitoring"] }

target "image" {
  context    = "."
  dockerfile = "images/Dockerfile"
  args = {
    SOURCE_DATE_EPOCH      = SOURCE_DATE_EPOCH
    DEBIAN_MIRROR          = DEBIAN_MIRROR
    DEBIAN_SECURITY_MIRROR = DEBIAN_SECURITY_MIRROR
    DEBIAN_SNAPSHOT        = DEBIAN_SNAPSHOT
    LOCKED                 = LOCKED
  }
  labels = {
    "org.opencontainers.image.licenses" = "BSD-3-Clause"
    "org.opencontainers.image.revision" = REVISION
    "org.opencontainers.image.source"   = SOURCE
    "org.opencontainers.image.version"  = VERSION
  }
  # provenance would record when and where, and thus change the digest
  attest = ["type=provenance,disabled=true"]
}

target "webserver" {
  inherits  = ["image"]
  target    = "webserver"
  args      = { IMAGE = "webserver" }
  labels    = { "org.opencontainers.image.title" = "LaserBot Battle: ROS master, rosbridge and web server" }
  platforms = ["linux/amd64", "linux/arm64"]
  tags      = ["webserver:${VERSION}"]
}

target "rosberry" {
  inherits  = ["image"]
  target    = "rosberry"
  args      = { IMAGE = "rosberry" }
  labels    = { "org.opencontainers.image.title" = "LaserBot Battle: a robot" }
  platforms = FEWER_PLATFORMS ? ["linux/arm/v7", "linux/amd64"] : ["linux/arm/v7", "linux/arm64", "linux/amd64"]
  tags      = ["rosberry:${VERSION}"]
}

# the virtual robots of the demo; never on a real robot or master
target "sim" {
  inherits  = ["image"]
  target    = "sim"
  args      = { IMAGE = "sim" }
  labels    = { "org.opencontainers.image.title" = "LaserBot Battle: virtual robots and their arena" }
  platforms = FEWER_PLATFORMS ? ["linux/arm/v7", "linux/amd64"] : ["linux/amd64", "linux/arm64", "linux/arm/v7"]
  tags      = ["sim:${VERSION}"]
}

# Prometheus and Alertmanager beside a master
target "monitoring" {
  inherits  = ["image"]
  target    = "monitoring"
  args      = { IMAGE = "monitoring" }
  labels    = { "org.opencontainers.image.title" = "LaserBot Battle: Prometheus and Alertmanager" }
  platforms = FEWER_PLATFORMS ? ["linux/arm64"] : ["linux/amd64", "linux/arm64"]
  tags      = ["monitoring:${VERSION}"]
}

target "demo" {
  name      = "demo-${image}"
  matrix    = { image = ["webserver", "rosberry", "sim"] }
  inherits  = [image]
  platforms = [] # that of the engine
}
