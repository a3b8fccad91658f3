# The command line in a container, from the Linux programs of a release, which lie in `programs`: docs/releasing.md has the command.
# The target `render` adds a Vulkan driver that draws on the CPU, a quarter of a gigabyte that only `gaitway render` needs.
FROM debian:trixie-slim AS unpacked
ARG TARGETARCH
COPY programs /programs
RUN case "$TARGETARCH" in amd64) cpu=x86_64 ;; arm64) cpu=aarch64 ;; *) exit 1 ;; esac \
  && mkdir /gaitway \
  && tar -xzf "/programs/gaitway-$cpu-unknown-linux-gnu.tar.gz" -C /gaitway --strip-components 1

FROM debian:trixie-slim AS cli
COPY --from=unpacked /gaitway/gaitway /usr/local/bin/
COPY --from=unpacked /gaitway/share /usr/local/share
COPY --from=unpacked /gaitway/LICEN* /usr/share/doc/gaitway/
WORKDIR /work
# An unprivileged user. With `docker run --user`, written files belong to the user it names.
USER 65534:65534
ENTRYPOINT ["gaitway"]
CMD ["--help"]

FROM cli AS render
USER 0:0
# The driver of the day, with its fixes.
# hadolint ignore=DL3008
RUN apt-get update \
  && apt-get install --yes --no-install-recommends libvulkan1 mesa-vulkan-drivers \
  && rm -rf /var/lib/apt/lists/*
USER 65534:65534

# Without a target, the small one.
FROM cli
