# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# The command in a container of Debian 12. Its steps are those that scripts/bare_debian tries; as a Dockerfile it is untried.
#
#   docker build -t morula .
#   docker run --rm -v "$PWD:/meshes" morula build liver.obj -o liver.morula

FROM debian:12 AS build
COPY . /src
WORKDIR /src
RUN apt-get update \
 && scripts/setup --no-browser \
 && cmake --preset release -D MORULA_TESTS=OFF -D MORULA_BENCH=OFF -D MORULA_BITS=OFF -D MORULA_EXAMPLES=OFF -D MORULA_PYTHON=OFF \
 && cmake --build --preset release \
 && cd build/release && cpack -G DEB -B /packages

FROM debian:12-slim
COPY --from=build /packages/morula_*.deb /packages/
RUN apt-get update \
 && apt-get install -y --no-install-recommends /packages/morula_*.deb \
 && rm -rf /var/lib/apt/lists/* /packages
WORKDIR /meshes
ENTRYPOINT ["morula"]
