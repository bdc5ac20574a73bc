// SPDX-License-Identifier: Apache-2.0
#error "the hardware target has neither Bullet nor EGL nor epoxy"
