# The command line and its page on one machine: docs/install.md.  docker build -f containers/program.Dockerfile -t resilin .
FROM debian:12 AS build
COPY scripts/setup.sh /source/scripts/setup.sh
RUN apt-get update && root=/source bash -c 'source /source/scripts/setup.sh && install_packages "${build_packages[@]}"' && \
    rm -rf /var/lib/apt/lists/*
COPY . /source
WORKDIR /source
# Kernels for every instruction set: the machine that builds need not be the one that runs.
RUN cmake --preset release -DRESILIN_BUILD_TESTS=OFF -DRESILIN_INSTRUCTION_SETS=all -DRESILIN_WITH_CHOLMOD=OFF && \
    cmake --build --preset release --target resilin && strip build/release/apps/cli/resilin

FROM debian:12-slim
RUN apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends \
    libopenblas0-pthread libmetis5 libtbb12 libtomlplusplus3 libfmt9 libfreetype6 libpng16-16 && rm -rf /var/lib/apt/lists/*
COPY --from=build /source/build/release/apps/cli/resilin /usr/local/bin/resilin
WORKDIR /data
ENTRYPOINT ["resilin"]
CMD ["info"]
