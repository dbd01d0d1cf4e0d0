# dem in a container of Debian 12:
#
#   docker build -t dem .
#   docker run --rm -v "$PWD":/data dem fill N36E008.hgt filled.tif
FROM debian:12-slim AS build
COPY . /libdem
WORKDIR /libdem
RUN scripts/setup.sh
RUN cmake --preset release -B /build -DDEM_BUILD_TESTS=OFF -DDEM_BUILD_BENCH=OFF \
 && cmake --build /build \
 && cd /build && cpack -G DEB

FROM debian:12-slim
COPY --from=build /build/libdem_*.deb /tmp/
RUN apt-get update \
 && apt-get install --yes --no-install-recommends /tmp/libdem_*.deb \
 && rm -rf /tmp/libdem_*.deb /var/lib/apt/lists/*
WORKDIR /data
ENTRYPOINT ["dem"]
