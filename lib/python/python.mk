# geotex for Python: `make wheel` builds build/geotex-VERSION-py3-none-PLATFORM.whl.
# Needs Debian's python3-cffi; the tests also python3-numpy and python3-venv.
PYTHON ?= /usr/bin/python3
python := $(out)/python
wheel   = $(build)/geotex-$(VERSION)-py3-none-$(shell $(PYTHON) -c 'import sysconfig; \
            print(sysconfig.get_platform().replace("-", "_").replace(".", "_"))').whl

# The headers without what cffi cannot parse: directives, attributes, the C library's own types.
$(python)/headers.i: $(addprefix include/geotex/,export.h cook.h grid.h geotex.h)
	@mkdir -p $(@D)/none && touch $(@D)/none/stddef.h $(@D)/none/stdint.h
	$(Q)$(CC) -E -P -nostdinc -U__GNUC__ -I$(@D)/none -Iinclude $< -o $@

# Without debug data, a tenth.
$(python)/.libraries: $(so_core) $(so_cook) $(modules)
	@rm -rf $(python)/lib && mkdir -p $(python)/lib
	$(Q)strip --strip-unneeded -o $(python)/lib/libgeotex.so $(so_core)
	$(Q)strip --strip-unneeded -o $(python)/lib/libgeotex-cook.so $(so_cook)
	$(Q)for m in $(modules); do strip --strip-unneeded -o $(python)/lib/$$(basename $$m) $$m; done
	@touch $@

python_needs := lib/python/wheel.py lib/python/README.md $(wildcard lib/python/geotex/*) \
                $(python)/.libraries $(python)/headers.i
$(python)/.wheel: $(python_needs)
	$(say) WHEEL $(wheel)
	$(Q)$(PYTHON) lib/python/wheel.py lib/python/geotex $(python)/lib $(python)/headers.i \
	  $(VERSION) $(wheel)
	@echo $(abspath $(wheel)) > $@

wheel: $(python)/.wheel ## the Python package geotex as a wheel in build/ (needs python3-cffi)
	@cat $(python)/.wheel

python-test: ## the wheel, installed in a fresh virtual environment
	$(again) deps
	$(again) test-python

# Where cffi is there the tests have a wheel; where it is not they are skipped.
$(python)/.tried: $(python_needs)
	@if $(PYTHON) -c 'import cffi' 2>/dev/null; then $(MAKE) --no-print-directory \
	  $(python)/.wheel && touch $@; fi
$(filter $(out)/tests/python/%,$(test_bins)): | $(python)/.tried
.PHONY: wheel python-test
