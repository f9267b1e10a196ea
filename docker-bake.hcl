# The images and their platforms. ci/images prepares what this needs and calls it.
variable "VERSION" { default = "0" }
variable "REVISION" { default = "" }
variable "SOURCE" { default = "" }
variable "SOURCE_DATE_EPOCH" { default = "0" }
# true: only for the platforms on which `make test` starts the images
variable "FEWER_PLATFORMS" { default = false }

group "default" { targets = ["webserver", "rosberry", "sim", "monitoring"] }

target "image" {
  context    = "."
  dockerfile = "images/Dockerfile"
  contexts = {
    base     = "docker-image://localhost/laserbot/base:trixie"
    packages = "build/packages"
  }
  args = { SOURCE_DATE_EPOCH = SOURCE_DATE_EPOCH }
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
