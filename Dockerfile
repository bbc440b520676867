# fenics_contact on Debian 13, with Debian's own FEniCSx. README.md says how to use it.
FROM debian:trixie-slim

# What only programmers or readers need is not unpacked: 1 GB less. Forms are compiled when
# they are first used, in C; that needs gcc's own libraries and libc_nonshared.a.
RUN printf '%s\n' \
        'path-exclude=/usr/share/doc/*' \
        'path-include=/usr/share/doc/*/copyright' \
        'path-exclude=/usr/share/man/*' \
        'path-exclude=/usr/share/locale/*' \
        'path-exclude=/usr/share/unicode/*' \
        'path-exclude=/usr/share/javascript/mathjax/*' \
        'path-exclude=/usr/include/boost/*' \
        'path-exclude=/usr/lib*/valgrind/*' \
        'path-exclude=/usr/lib/*-linux-gnu/*.a' \
        'path-include=/usr/lib/gcc/*' \
        'path-include=/usr/lib/*/libc_nonshared.a' \
        >/etc/dpkg/dpkg.cfg.d/fenics_contact

# The same packages as in bootstrap (a test compares them). Without OpenBLAS, MUMPS is ten
# times slower; Debian's VTK draws nothing without an X server.
RUN apt-get update \
    && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends \
        python3-dolfinx python3-dolfinx-real python3-gmsh python3-pyvista python3-scipy \
        python3-pydantic python3-tomlkit python3-jinja2 python3-matplotlib python3-plotly \
        python3-rich python3-pytest python3-pytest-xdist python3-hypothesis python3-jsonschema \
        python3-venv libopenblas0-serial xvfb xauth python3-meshio python3-h5py python3-pint python3-tornado gcc libc6-dev \
        python3-dev openmpi-bin \
    && apt-get clean \
    && rm -rf /var/lib/apt/lists/*

# Any user id will do, also one without a name (docker run --user): all that is written goes
# to /tmp and /results. One thread a rank; any number of ranks, within one machine, and not
# spinning while they wait (on one core that made two ranks 60 times slower).
ENV LANG=C.UTF-8 \
    HOME=/tmp \
    XDG_CACHE_HOME=/tmp/cache \
    PYTHONPATH=/opt/fenics_contact \
    OMP_NUM_THREADS=1 \
    OMPI_ALLOW_RUN_AS_ROOT=1 \
    OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
    OMPI_MCA_btl=self,sm \
    OMPI_MCA_mpi_yield_when_idle=1 \
    PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe

RUN useradd --uid 1000 --home-dir /tmp contact \
    && printf '#!/bin/sh\nexec python3 -m fenics_contact "$@"\n' >/usr/local/bin/fenics-contact \
    && chmod 755 /usr/local/bin/fenics-contact \
    && mkdir --mode 1777 /results

# With `results` a link, commands read as they do in a checkout.
WORKDIR /opt/fenics_contact
COPY . .

# The demo is run once: its compiled forms are kept, and the entry script copies them.
RUN ln -s /results results \
    && XDG_CACHE_HOME=/var/cache/fenics_contact python3 demos/demo_slab.py --out /tmp/slab \
    && find /tmp -mindepth 1 -delete \
    && python3 -m compileall -q . \
    && chmod -R a+rX . /var/cache/fenics_contact

USER contact
VOLUME /results
ENTRYPOINT ["/opt/fenics_contact/docker/entrypoint"]
CMD ["demo"]
