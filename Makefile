# The commands of LaserBot Battle. Each first installs and builds what it needs.
.PHONY: help demo test test-all lint bench scale soak setup clean

help:
	@echo 'make demo [ROBOTS=2] [BOTS=1]  a whole battle on this machine, to play in the browser;'
	@echo '                               OVERHEAD=1: robots get their places by a camera above the floor'
	@echo 'make test                      what every change must pass: 20 minutes, 16 GB of disk'
	@echo 'make test-all                  everything, including the slow tests: before a release'
	@echo 'make lint                      style and types of the sources'
	@echo 'make bench                     figures: latencies, stop time, stepper speed'
	@echo 'make scale [N="8 100"] [SECONDS=20]  how many players one master carries'
	@echo 'make soak [MINUTES=30] [SEED=7]  a long evening in which parts fail at random'
	@echo 'make images                    the container images; PUSH=host:port, ARCHIVE=file, PLATFORM=linux/arm/v7'
	@echo 'make cards                     the SD cards of a robot and a master, and their update: build/cards/laserbot-*'
	@echo 'make fleet [HOSTS=3]           a master and robots like real hosts, deployed over SSH; make fleet-down removes them'
	@echo 'make fleet-faults              reboots, cuts and kills in that fleet; prints the recovery times'
	@echo 'make setup                     only installs and builds what the others need'
	@echo 'make images-lock               newer Debian packages for the images'
	@echo 'make clean                     removes what was built (not the Debian packages)'

ROBOTS ?= 2
BOTS ?= 1

demo:
	@case '$(ROBOTS)$(BOTS)' in *[!0-9]*) echo 'make demo: ROBOTS and BOTS are numbers' >&2; exit 2; esac
	@ci/setup run
	@exec ci/demo --robots '$(ROBOTS)' --bots '$(BOTS)' $(if $(filter-out 0,$(OVERHEAD)),--overhead)

test:
	@exec ci/test

test-all:
	@exec ci/test all

lint:
	@ci/setup test
	@exec ci/lint

bench:
	@ci/setup test
	@exec ci/bench

N ?= 8 32 64 100 128
SECONDS ?= 20

scale:
	@ci/setup test
	@exec ci/scale --players $(N) --seconds '$(SECONDS)'

MINUTES ?= 30

soak:
	@ci/setup test
	@exec ci/soak --minutes '$(MINUTES)' $(if $(SEED),--seed '$(SEED)')

setup:
	@ci/setup test

clean:
	rm -rf build .venv node_modules server/static/bundle

# ---- images ----
.PHONY: images images-lock

images:
	@ci/setup images
	@exec ci/images

images-lock:
	@exec ci/images-lock

# ---- SD cards ----
.PHONY: cards

cards:
	@ci/setup cards
	@exec ci/cards

# ---- the fleet, rehearsed ----
.PHONY: fleet fleet-down fleet-faults
HOSTS ?= 3

fleet:
	@ci/setup fleet
	@exec ci/fleet up '$(HOSTS)'

fleet-down:
	@exec ci/fleet down

fleet-faults:
	@ci/setup fleet
	@ci/fleet up
	@exec ci/fleet test --timeout=1800 tests/fleet/faults
