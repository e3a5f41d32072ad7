"use strict";
(() => {
  const tip = document.getElementById("tip");

  // A point shows what it stands for under the pointer and in focus. Its title would show a second time.
  const show = (point) => {
    tip.textContent = point.dataset.tip;
    tip.hidden = false;
    const box = point.querySelector("circle").getBoundingClientRect();
    const left = box.left + box.width / 2 - tip.offsetWidth / 2;
    const widest = document.documentElement.clientWidth - tip.offsetWidth - 4;
    const above = box.top - tip.offsetHeight - 6;
    tip.style.left = `${scrollX + Math.max(4, Math.min(left, widest))}px`;
    tip.style.top = `${scrollY + (above < 4 ? box.bottom + 6 : above)}px`;
  };
  const hide = () => { tip.hidden = true; };

  // One stop of the tab key per panel; arrows go along a curve and from curve to curve.
  const reach = (point) => {
    for (const other of point.closest(".panel").querySelectorAll(".point")) {
      other.tabIndex = other === point ? 0 : -1;
    }
  };
  const step = (point, key) => {
    const lines = [...point.closest(".panel").querySelectorAll(".line")].filter((line) => line.querySelector(".point"));
    const points = (line) => [...line.querySelectorAll(".point")];
    const line = lines.indexOf(point.closest(".line"));
    const place = points(lines[line]).indexOf(point);
    const [along, across] = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[key];
    const others = points(lines[(line + across + lines.length) % lines.length]);
    return others[Math.max(0, Math.min(place + along, others.length - 1))];
  };
  for (const point of document.querySelectorAll(".point")) {
    const title = point.querySelector("title");
    point.dataset.tip = title.textContent;
    point.setAttribute("role", "img");
    point.setAttribute("aria-label", title.textContent.replaceAll("\n", ", "));
    title.remove();
    point.tabIndex = point === point.closest(".panel").querySelector(".point") ? 0 : -1;
    point.addEventListener("pointerenter", () => show(point));
    point.addEventListener("pointerleave", hide);
    point.addEventListener("focus", () => { reach(point); show(point); });
    point.addEventListener("blur", hide);
    point.addEventListener("keydown", (event) => {
      if (event.key === "Escape") {
        hide();
      } else if (event.key.startsWith("Arrow")) {
        event.preventDefault();
        step(point, event.key).focus();
      }
    });
  }

  for (const radio of document.querySelectorAll("[name=metric]")) {
    radio.addEventListener("change", () => {
      for (const panels of document.querySelectorAll(".panels")) {
        panels.hidden = panels.dataset.metric !== radio.value;
      }
      hide();
    });
  }

  for (const viewer of document.querySelectorAll(".viewer")) {
    const split = viewer.querySelector(".split");
    const handle = viewer.querySelector(".handle");
    const [under, over] = split.querySelectorAll("img");
    const [left, right] = viewer.querySelectorAll("select");
    const choose = (select, picture) => {
      const source = document.getElementById(select.value);
      picture.src = source.src;
      picture.alt = source.alt;
    };
    const move = (percent) => {
      const at = Math.max(0, Math.min(percent, 100));
      split.style.setProperty("--at", `${at}%`);
      handle.setAttribute("aria-valuenow", Math.round(at));
      handle.setAttribute("aria-valuetext", `${Math.round(at)} % of the left picture`);
    };
    const now = () => Number(handle.getAttribute("aria-valuenow"));
    const follow = (event) => {
      const box = split.getBoundingClientRect();
      move(((event.clientX - box.left) / box.width) * 100);
    };
    left.addEventListener("change", () => choose(left, over));
    right.addEventListener("change", () => choose(right, under));
    split.addEventListener("pointerdown", (event) => {
      if (event.button === 0) {
        event.preventDefault();
        split.setPointerCapture(event.pointerId);
        handle.focus({ preventScroll: true });
        follow(event);
      }
    });
    split.addEventListener("pointermove", (event) => {
      if (split.hasPointerCapture(event.pointerId)) {
        follow(event);
      }
    });
    handle.addEventListener("keydown", (event) => {
      const fine = event.shiftKey ? 10 : 1;
      const targets = {
        ArrowLeft: now() - fine, ArrowDown: now() - fine, ArrowRight: now() + fine, ArrowUp: now() + fine,
        PageDown: now() - 10, PageUp: now() + 10, Home: 0, End: 100,
      };
      if (event.key in targets) {
        event.preventDefault();
        move(targets[event.key]);
      }
    });
    choose(left, over);
    choose(right, under);
    move(50);
    viewer.hidden = false;
  }
})();
