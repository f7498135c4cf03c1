# Wavesplat's commands in a container, built from this checkout:
#
#   docker build -t wavesplat .
#   docker run --rm -v "$PWD:/data" wavesplat render scan.nii.gz -o scan.png
#
# It runs as a user without rights, in /data. The viewer is not for containers: its server listens on the loopback
# interface alone.
FROM rust:1.95-slim-bookworm AS build
SHELL ["/bin/bash", "-o", "pipefail", "-c"]
RUN apt-get update && apt-get install -y --no-install-recommends python3=3.11.* python3-venv=3.11.* \
    && rm -rf /var/lib/apt/lists/*
RUN python3 -m venv /tools && /tools/bin/pip install --no-cache-dir "maturin>=1.16,<2"
WORKDIR /source
COPY Cargo.toml Cargo.lock pyproject.toml README.md LICENSE-MIT LICENSE-APACHE ./
COPY crates crates
COPY python python
RUN /tools/bin/maturin build --release --locked --strip --out /wheels

FROM python:3.13-slim-bookworm
COPY --from=build /wheels /wheels
ARG EXTRAS=movie,mesh,body,figure,http,dask,netcdf,vtk,geometry,parquet
RUN wheel="$(echo /wheels/*.whl)" && pip install --no-cache-dir "wavesplat[$EXTRAS] @ file://$wheel" && rm -r /wheels \
    && useradd --create-home --uid 1000 user
USER 1000
WORKDIR /data
ENTRYPOINT ["wavesplat"]
CMD ["--help"]
